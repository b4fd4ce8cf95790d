"""Reference cells of quadratic meshes: nodes in basix order, shape functions, integration rules."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Kinds of cells of a meridian.
CellKind = Literal["triangles", "quadrilaterals"]

# Edges of the reference simplices as pairs of local corners, in the order of basix' degree-2 Lagrange nodes
# (basix numbers an edge by the corners it does not touch, lexicographically).
TRIANGLE_EDGES = ((1, 2), (0, 2), (0, 1))
TETRAHEDRON_EDGES = ((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1))

# Nodes of the square and the cube as half steps (0, 1, 2) along each axis, in basix order: corners (the first axis
# fastest), edges, faces, interior.
QUADRILATERAL_NODES: IntArray = np.array([[0, 0], [2, 0], [0, 2], [2, 2], [1, 0], [0, 1], [2, 1], [1, 2], [1, 1]])
# Edges of a quadrilateral as pairs of local corners, in the order of their mid-edge nodes.
QUADRILATERAL_EDGES = ((0, 1), (0, 2), (1, 3), (2, 3))
_CORNERS = [(a, b, c) for c in (0, 2) for b in (0, 2) for a in (0, 2)]
_EDGES = [(0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7)]
_FACES = ((0, 1, 2, 3), (0, 1, 4, 5), (0, 2, 4, 6), (1, 3, 5, 7), (2, 3, 6, 7), (4, 5, 6, 7))
_CUBE = np.array(_CORNERS)
HEXAHEDRON_NODES: IntArray = np.vstack(
    [
        _CUBE,
        [_CUBE[list(edge)].mean(axis=0) for edge in _EDGES],
        [_CUBE[list(face)].mean(axis=0) for face in _FACES],
        [[1, 1, 1]],
    ]
).astype(np.int64)


@dataclass(frozen=True)
class CellShape:
    """A quadratic reference cell.

    Attributes
    ----------
    name
        ``triangle``, ``tetrahedron``, ``quadrilateral`` or ``hexahedron``.
    dimension
        2 or 3.
    corners
        Number of corners; they come first among the nodes.
    nodes
        Places of the nodes in the reference cell, shape (k, d).
    facets
        Corners of each facet.
    shape
        Function of points (q, d) giving the shape functions (q, k) and their gradients (q, k, d).
    rule
        Integration points (q, d) and weights (q,), all positive.
    """

    name: str
    dimension: int
    corners: int
    nodes: FloatArray
    facets: tuple[tuple[int, ...], ...]
    shape: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    rule: tuple[FloatArray, FloatArray]


def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss' rule on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def _simplex_rule(dimension: int, count: int = 4) -> tuple[FloatArray, FloatArray]:
    """Collapsed Gauss rule on the reference simplex."""
    x, w = _gauss(count)
    points, weights = [], []
    for combo in itertools.product(range(count), repeat=dimension):
        position, left, weight = [], 1.0, 1.0
        for k in combo:
            position.append(x[k] * left)
            weight *= w[k] * left
            left *= 1.0 - x[k]
        points.append(position)
        weights.append(weight)
    return np.array(points), np.array(weights)


def _box_rule(dimension: int, count: int = 4) -> tuple[FloatArray, FloatArray]:
    """Gauss' rule on the unit square or cube; one point more than a solver needs sees folds it would miss."""
    x, w = _gauss(count)
    points = np.stack(np.meshgrid(*[x] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    weights = np.stack(np.meshgrid(*[w] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    return points, weights.prod(axis=1)


def _simplex_shape(edges: tuple[tuple[int, int], ...]) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    def shape(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        dimension = at.shape[1]
        bary = np.column_stack([1.0 - at.sum(axis=1), at])
        grad = np.vstack([-np.ones(dimension), np.eye(dimension)])
        values = [bary[:, i] * (2.0 * bary[:, i] - 1.0) for i in range(dimension + 1)]
        grads = [(4.0 * bary[:, i] - 1.0)[:, None] * grad[i] for i in range(dimension + 1)]
        for i, j in edges:
            values.append(4.0 * bary[:, i] * bary[:, j])
            grads.append(4.0 * (bary[:, i][:, None] * grad[j] + bary[:, j][:, None] * grad[i]))
        return np.stack(values, axis=1), np.stack(grads, axis=1)

    return shape


def quadratic_weights(x: FloatArray) -> FloatArray:
    """Lagrange polynomials for nodes at 0, 1/2 and 1, shape (..., 3)."""
    return np.stack([(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)], axis=-1)


def _box_shape(nodes: IntArray) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    def shape(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        dimension = at.shape[1]
        value = quadratic_weights(at)  # (q, d, 3)
        slope = np.stack([4.0 * at - 3.0, 4.0 - 8.0 * at, 4.0 * at - 1.0], axis=-1)
        axes = np.arange(dimension)
        each = value[:, axes, nodes]  # (q, k, d): one factor per axis
        grads = np.repeat(each.prod(axis=2)[:, :, None], dimension, axis=2)
        for i in axes:
            factors = each.copy()
            factors[:, :, i] = slope[:, i, nodes[:, i]]
            grads[:, :, i] = factors.prod(axis=2)
        return each.prod(axis=2), grads

    return shape


def _simplex_nodes(dimension: int, edges: tuple[tuple[int, int], ...]) -> FloatArray:
    corners = np.vstack([np.zeros(dimension), np.eye(dimension)])
    return np.vstack([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])


_SHAPES = {
    (2, 6): CellShape(
        "triangle",
        2,
        3,
        _simplex_nodes(2, TRIANGLE_EDGES),
        TRIANGLE_EDGES,
        _simplex_shape(TRIANGLE_EDGES),
        _simplex_rule(2),
    ),
    (3, 10): CellShape(
        "tetrahedron",
        3,
        4,
        _simplex_nodes(3, TETRAHEDRON_EDGES),
        ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)),
        _simplex_shape(TETRAHEDRON_EDGES),
        _simplex_rule(3),
    ),
    (2, 9): CellShape(
        "quadrilateral",
        2,
        4,
        0.5 * QUADRILATERAL_NODES,
        QUADRILATERAL_EDGES,
        _box_shape(QUADRILATERAL_NODES),
        _box_rule(2),
    ),
    (3, 27): CellShape("hexahedron", 3, 8, 0.5 * HEXAHEDRON_NODES, _FACES, _box_shape(HEXAHEDRON_NODES), _box_rule(3)),
}


def cell_shape(dimension: int, nodes: int) -> CellShape:
    """The reference cell of a dimension with a number of nodes."""
    return _SHAPES[dimension, nodes]
