"""Uniform refinement of a mesh whose cells stay in place: children are parts of their parent's own quadratic map.

Each edge is halved, so a cell gives four children, in 3D eight. What a mesh says of a body's shape is kept to
round-off: differences between a mesh and its children are the discretisation's alone.
"""

from __future__ import annotations

import dataclasses
import itertools
from functools import lru_cache

import numpy as np

from meshes.cells import CellShape, FloatArray, IntArray, cell_shape
from meshes.solid import SolidMesh

# Steps of the lattice on which the children's nodes lie: two children along an edge, each with a node midway.
STEPS = 4


def linear_weights(cell: CellShape, at: FloatArray) -> FloatArray:
    """First-order shape functions of the corners at places (q, d) of a reference cell, shape (q, corners)."""
    if cell.corners == cell.dimension + 1:
        return np.column_stack([1.0 - at.sum(axis=1), at])
    far = cell.nodes[: cell.corners] > 0.5
    return np.asarray(np.where(far, at[:, None], 1.0 - at[:, None]).prod(axis=2))


def numbered(corners: IntArray, weights: IntArray) -> tuple[IntArray, IntArray]:
    """Numbers of places in cells, the same in all cells that share them.

    A place is told by the corners it lies between and its weights of them, which cells that share a facet agree on.

    Parameters
    ----------
    corners
        Nodes at the corners of each cell, shape (m, c).
    weights
        First-order weights of the places, as whole numbers, shape (q, c).

    Returns
    -------
    numbers
        Shape (m, q).
    first
        For each number one of its places: m' q + q'.
    """
    codes = np.where(weights > 0, corners[:, None] * (weights.max() + 1) + weights, -1)
    rows = np.sort(codes, axis=2)[:, :, ::-1].reshape(-1, corners.shape[1])
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return back.reshape(len(corners), len(weights)), first


def refined(mesh: SolidMesh) -> SolidMesh:
    """The mesh with each edge halved; regions and named facets are the parents'.

    Parameters
    ----------
    mesh
        A mesh that was not revolved: what its nodes came from is not carried over.
    """
    cell = mesh.cell
    at = _lattice(cell.name)
    weights = np.rint(linear_weights(cell, at / STEPS) * STEPS**cell.dimension).astype(np.int64)
    corners = mesh.cells[:, : cell.corners]
    lattice, first = numbered(corners, weights)
    values, _ = cell.shape(at / STEPS)
    parent, which = np.divmod(first, len(at))
    points = np.einsum("nk,nkd->nd", values[which], mesh.points[mesh.cells[parent]])

    cells, parents, facets, of = [], [], [], []
    facet_of = {tuple(f): k for k, f in enumerate(mesh.facets.tolist())}
    named = np.isin(corners, mesh.facets)
    for choice, chosen in enumerate(_diagonals(mesh)):
        for child in _children(cell.name, choice):
            cells.append(lattice[chosen][:, child])
            parents.append(chosen)
        for facet, parts in _facets_of_children(cell.name, choice):
            candidates = chosen[named[chosen][:, facet].all(axis=1)]
            found = [facet_of.get(tuple(f), -1) for f in np.sort(corners[candidates][:, facet], axis=1).tolist()]
            hit = np.array(found, dtype=np.int64) >= 0
            for part in parts:
                facets.append(np.sort(lattice[candidates[hit]][:, part], axis=1))
                of.append(np.array(found, dtype=np.int64)[hit])
    facet_parents = np.concatenate(of)
    tip = np.flatnonzero((mesh.cells == mesh.tip_centre_node).any(axis=1))[0]
    node = int(np.argmax(mesh.cells[tip] == mesh.tip_centre_node))
    there = int(np.argmin(np.abs(at / STEPS - cell.nodes[node]).sum(axis=1)))
    return dataclasses.replace(
        mesh,
        points=points,
        cells=np.vstack(cells),
        regions=mesh.regions[np.concatenate(parents)],
        facets=np.vstack(facets),
        facet_tags=mesh.facet_tags[facet_parents],
        facet_bodies=mesh.facet_bodies[facet_parents],
        tip_centre_node=int(lattice[tip, there]),
    )


# --- children of the reference cells --------------------------------------------------------------------------


@lru_cache(maxsize=4)
def _lattice(name: str) -> IntArray:
    """Places of the children's nodes in steps of a quarter, shape (q, d)."""
    dimension = 3 if name in ("tetrahedron", "hexahedron") else 2
    every = np.array(list(itertools.product(range(STEPS + 1), repeat=dimension)))
    return every if name in ("quadrilateral", "hexahedron") else every[every.sum(axis=1) <= STEPS]


# The octahedron in the middle of a tetrahedron is cut along one of three diagonals, which join middles of opposite
# edges: these pairs of edges, by their corners.
_OPPOSITE = (((0, 1), (2, 3)), ((0, 2), (1, 3)), ((0, 3), (1, 2)))


def _diagonals(mesh: SolidMesh) -> list[IntArray]:
    """Cells by how they are cut; tetrahedra along the shortest diagonal, which keeps the children's shape best."""
    every = np.arange(len(mesh.cells))
    if mesh.cell.name != "tetrahedron":
        return [every]
    corner = mesh.points[mesh.cells[:, :4]]
    lengths = [
        np.linalg.norm(corner[:, list(a)].sum(axis=1) - corner[:, list(b)].sum(axis=1), axis=1) for a, b in _OPPOSITE
    ]
    shortest = np.argmin(lengths, axis=0)
    return [every[shortest == k] for k in range(len(_OPPOSITE))]


@lru_cache(maxsize=12)
def _children(name: str, choice: int) -> tuple[list[int], ...]:
    """Nodes of each child as numbers of lattice places, in basix order."""
    lattice = _lattice(name)
    dimension = lattice.shape[1]
    place = {tuple(p): k for k, p in enumerate(lattice.tolist())}
    corners = _child_corners(name, dimension, choice)
    cell = cell_shape(dimension, {"triangle": 6, "quadrilateral": 9, "tetrahedron": 10, "hexahedron": 27}[name])
    nodes = linear_weights(cell, cell.nodes)
    return tuple([place[tuple(p)] for p in np.rint(nodes @ child).astype(int).tolist()] for child in corners)


def _child_corners(name: str, dimension: int, choice: int) -> list[IntArray]:
    """Corners of the children in steps of a quarter, each positively oriented."""
    if name in ("quadrilateral", "hexahedron"):
        cube = np.array([[2 * ((k >> i) & 1) for i in range(dimension)] for k in range(2**dimension)])
        return [cube + corner for corner in cube]
    corner = STEPS * np.vstack([np.zeros((1, dimension), dtype=int), np.eye(dimension, dtype=int)])
    children = [(corner + c) // 2 for c in corner]
    middle = {
        pair: (corner[pair[0]] + corner[pair[1]]) // 2 for pair in itertools.combinations(range(dimension + 1), 2)
    }
    if dimension == 2:
        children.append(np.array([middle[1, 2], middle[0, 2], middle[0, 1]]))
    else:
        ends = _OPPOSITE[choice]
        ring = [pair for pair in middle if pair not in ends]
        beside = [pair for pair in ring[1:] if set(pair) & set(ring[0])]
        (across,) = set(ring[1:]) - set(beside)
        round_it = [ring[0], beside[0], across, beside[1]]
        for one, other in zip(round_it, [*round_it[1:], ring[0]], strict=True):
            children.append(np.array([middle[ends[0]], middle[ends[1]], middle[one], middle[other]]))
    return [_turned(child) for child in children]


def _turned(child: IntArray) -> IntArray:
    """A simplex with two corners exchanged if it is negatively oriented."""
    if np.linalg.det((child[1:] - child[0]).astype(float)) > 0.0:
        return child
    return child[[0, 2, 1, *range(3, len(child))]]


@lru_cache(maxsize=12)
def _facets_of_children(name: str, choice: int) -> list[tuple[list[int], list[list[int]]]]:
    """For each facet of the parent, as its corners, the corners of the children's facets on it as lattice numbers."""
    lattice = _lattice(name)
    children = _children(name, choice)
    dimension = lattice.shape[1]
    cell = cell_shape(dimension, len(children[0]))
    weights = linear_weights(cell, lattice / STEPS)
    out = []
    for facet in cell.facets:
        off = [k for k in range(cell.corners) if k not in facet]
        on = np.abs(weights[:, off]).sum(axis=1) < 1e-12
        parts = [[child[k] for k in own] for child in children for own in cell.facets]
        out.append((list(facet), [part for part in parts if on[part].all()]))
    return out
