"""Users' meshes for tests: lattices of triangles or tetrahedra, mapped to bodies, and written as gmsh files."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from meshes.solid import TETRAHEDRON_EDGES, TRIANGLE_EDGES

# gmsh's place of each node of ours: mid-edge nodes are counted otherwise.
_GMSH = {6: [0, 1, 2, 4, 5, 3], 10: [0, 1, 2, 3, 8, 9, 5, 7, 6, 4]}
_KINDS = {6: 9, 10: 11}  # gmsh's numbers of the cells
_FACETS = {2: 1, 3: 2}  # and of their facets, by dimension


class Lattice:
    """The unit square or cube in cells, two triangles or six tetrahedra each.

    Attributes
    ----------
    points, cells
        Nodes in [0, 1]^d, and cells with straight edges, in the order of `meshes.solid`.
    box
        Number of each cell's square or cube in each direction, shape (cells, d).
    """

    def __init__(self, counts: Sequence[int]) -> None:
        d, shape = len(counts), [2 * n + 1 for n in counts]
        grid = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, k) for k in shape], indexing="ij"), axis=-1)
        self.points = grid.reshape(-1, d)
        low = np.stack(np.meshgrid(*[np.arange(n) for n in counts], indexing="ij"), axis=-1).reshape(-1, d)
        cells, boxes = [], []
        for path in itertools.permutations(range(d)):  # Kuhn's simplices share their faces from box to box
            corners = [np.zeros(d, dtype=int)]
            for axis in path:
                corners.append(corners[-1] + 2 * np.eye(d, dtype=int)[axis])
            edges = TRIANGLE_EDGES if d == 2 else TETRAHEDRON_EDGES
            nodes = corners + [(corners[i] + corners[j]) // 2 for i, j in edges]
            cells.append(np.stack([np.ravel_multi_index((2 * low + at).T, shape) for at in nodes], axis=1))
            boxes.append(low)
        self.cells, self.box = np.vstack(cells), np.vstack(boxes)
        if d == 3:  # every second path is left-handed
            odd = np.linalg.det(np.diff(self.points[self.cells[:, :4]], axis=1)) < 0.0
            self.cells[odd] = self.cells[odd][:, [0, 2, 1, 3, 5, 4, 6, 7, 9, 8]]
        else:
            odd = np.linalg.det(np.diff(self.points[self.cells[:, :3]], axis=1)) < 0.0
            self.cells[odd] = self.cells[odd][:, [0, 2, 1, 3, 5, 4]]

    def facets(self, axis: int, at: float) -> np.ndarray:
        """Corners of the boundary's facets on a plane across an axis."""
        d = self.points.shape[1]
        corners = self.cells[:, : d + 1]
        facets = np.vstack([np.delete(corners, k, axis=1) for k in range(d + 1)])
        facets, count = np.unique(np.sort(facets, axis=1), axis=0, return_counts=True)
        facets = facets[count == 1]
        return facets[(np.abs(self.points[facets][:, :, axis] - at) < 1e-12).all(axis=1)]


def write_msh(
    path: Path,
    lattice: Lattice,
    place: Callable[[np.ndarray], np.ndarray],
    sides: Mapping[tuple[int, float], str],
    volumes: Mapping[str, np.ndarray] | None = None,
) -> Path:
    """Write a lattice as a gmsh file of version 2.2.

    Parameters
    ----------
    path
        The file.
    lattice, place
        The lattice, and where its nodes are: from (n, d) in [0, 1]^d to (n, d), mm.
    sides
        Names of the boundary's parts on planes (axis, place); several may have one name.
    volumes
        Which cells belong to each physical volume, by name; default all to ``rubber``. What is in none is unnamed.
    """
    points, d = place(lattice.points), lattice.points.shape[1]
    volumes = {"rubber": np.ones(len(lattice.cells), dtype=bool)} if volumes is None else volumes
    known = list(dict.fromkeys(sides.values()))
    names = [f'{d - 1} {k + 1} "{name}"' for k, name in enumerate(known)]
    names += [f'{d} {k + 101} "{name}"' for k, name in enumerate(volumes)]
    elements = []
    for (axis, at), name in sides.items():
        number = known.index(name) + 1
        for facet in lattice.facets(axis, at) + 1:
            elements.append(f"{_FACETS[d]} 2 {number} {number} {' '.join(map(str, facet))}")
    order = np.argsort(_GMSH[lattice.cells.shape[1]])
    region = np.zeros(len(lattice.cells), dtype=int)
    for number, cells in enumerate(volumes.values()):
        region[cells] = number + 101
    for cell, tag in zip(lattice.cells[:, order] + 1, region, strict=True):
        physical = f"{tag} {tag}" if tag else "0 1"
        elements.append(f"{_KINDS[lattice.cells.shape[1]]} 2 {physical} {' '.join(map(str, cell))}")
    full = np.zeros((len(points), 3))
    full[:, :d] = points
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(full)), *(f"{k + 1} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(full.tolist()))]
    lines += ["$EndNodes", "$Elements", str(len(elements)), *(f"{k + 1} {e}" for k, e in enumerate(elements))]
    path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="ascii")
    return path
