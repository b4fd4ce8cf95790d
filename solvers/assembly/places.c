/* See places.h. */

#include <stdint.h>
#include <string.h>
#include <ufcx.h>

#include "places.h"

/* The matrix of an entity with zeros in the rows and columns of held dofs, shape (size, size). */
static void element(const integral *of, const mesh *on, int32_t entity, double *restrict matrix)
{
  const int32_t cell = of->cells[entity], size = on->size;
  const int32_t *nodes = on->geometry + (int64_t)cell * on->nodes, *dofs = on->dofs + (int64_t)cell * size;
  const uint8_t permutation = 0; /* of interest between two cells only */
  double points[3 * on->nodes];
  for (int32_t i = 0; i < on->nodes; ++i)
    memcpy(points + 3 * i, on->points + 3 * (int64_t)nodes[i], 3 * sizeof(double));
  memset(matrix, 0, sizeof(double) * size * size);
  ((ufcx_tabulate_tensor_float64 *)of->kernel)(matrix, of->coefficients + (int64_t)entity * of->width, of->constants,
                                               points, of->facets + entity, &permutation
#ifdef CUSTOM_DATA
                                               , 0
#endif
  );
  for (int32_t i = 0; i < size; ++i)
    if (on->held[dofs[i]])
      for (int32_t j = 0; j < size; ++j)
        matrix[size * i + j] = matrix[size * j + i] = 0.0;
}

int64_t find_places(const mesh *on, const int32_t *chosen, int32_t count, const int64_t *starts, const int32_t *columns,
                    uint16_t *places)
{
  const int32_t size = on->size;
  int32_t order[size];
  int64_t lost = 0;
  for (int32_t k = 0; k < count; ++k)
  {
    const int32_t *dofs = on->dofs + (int64_t)chosen[k] * size;
    uint16_t *of_cell = places + (int64_t)chosen[k] * size * size;
    for (int32_t i = 0; i < size; ++i)
    {
      int32_t j = i;
      for (; j > 0 && dofs[order[j - 1]] > dofs[i]; --j)
        order[j] = order[j - 1];
      order[j] = i;
    }
    for (int32_t i = 0; i < size; ++i)
    {
      const int64_t first = starts[dofs[i]], end = starts[dofs[i] + 1];
      int64_t at = first;
      for (int32_t j = 0; j < size; ++j)
      {
        const int32_t column = dofs[order[j]];
        while (at < end && columns[at] < column)
          ++at;
        lost += at == end || columns[at] != column || at - first > UINT16_MAX;
        of_cell[size * i + order[j]] = (uint16_t)(at - first);
      }
    }
  }
  return lost;
}

static int all_zero(const double *row, int32_t size)
{
  for (int32_t j = 0; j < size; ++j)
    if (row[j] != 0.0)
      return 0;
  return 1;
}

void add_elements(const integral *of, const mesh *on, const int32_t *chosen, int32_t count, const int64_t *starts,
                  const uint16_t *places, uintptr_t values)
{
  const int32_t size = on->size;
  double matrix[size * size];
  for (int32_t k = 0; k < count; ++k)
  {
    const int64_t cell = of->cells[chosen[k]];
    const int32_t *dofs = on->dofs + cell * size;
    /* values come from memory while the element is computed; components of a node are mostly side by side */
    for (int32_t i = 0; i < size; ++i)
      for (int32_t j = 0; j < size; j += 3)
        __builtin_prefetch((double *)values + starts[dofs[i]] + places[(cell * size + i) * size + j], 1, 2);
    element(of, on, chosen[k], matrix);
    for (int32_t i = 0; i < size; ++i)
    {
      /* so are two in three rows of a facet's matrix */
      if (all_zero(matrix + size * i, size))
        continue;
      double *row = (double *)values + starts[dofs[i]];
      const uint16_t *place = places + (cell * size + i) * size;
      for (int32_t j = 0; j < size; ++j)
        row[place[j]] += matrix[size * i + j];
    }
  }
}

void list_elements(const integral *of, const mesh *on, const int32_t *chosen, int32_t count, double *matrices)
{
  for (int32_t k = 0; k < count; ++k)
    element(of, on, chosen[k], matrices + (int64_t)k * on->size * on->size);
}
