/* Element matrices of a compiled form's integrals, added to the values of a sparse matrix at places known beforehand.
   Also read by cffi, which takes no preprocessor. */

typedef struct
{
  uintptr_t kernel;           /* the form compiler's, of type ufcx_tabulate_tensor_float64 */
  const int32_t *cells;       /* of each entity */
  const int32_t *facets;      /* number of the facet in it */
  const double *coefficients; /* rows of width values, one for each entity */
  int32_t width;
  const double *constants;
} integral;

typedef struct
{
  int32_t nodes, size;
  const double *points;    /* of three coordinates */
  const int32_t *geometry; /* nodes of each cell */
  const int32_t *dofs;     /* size of each cell */
  const uint8_t *held;     /* which dofs are */
} mesh;

/* Where the entries of chosen cells' matrices are in the rows of a sparse matrix with ascending columns: how far from
   the row's start, shape (cells, size, size). Returns how many have no place, or one too far. */
int64_t find_places(const mesh *on, const int32_t *chosen, int32_t count, const int64_t *starts, const int32_t *columns,
                    uint16_t *places);

/* Add the matrices of chosen entities to the values; rows and columns of held dofs add nothing. */
void add_elements(const integral *of, const mesh *on, const int32_t *chosen, int32_t count, const int64_t *starts,
                  const uint16_t *places, uintptr_t values);

/* The matrices of chosen entities, rows and columns of held dofs zero, shape (count, size, size). */
void list_elements(const integral *of, const mesh *on, const int32_t *chosen, int32_t count, double *matrices);
