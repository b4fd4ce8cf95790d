"""A smooth curve through the nodes of a line of facets, and the gap of points to it with both derivatives.

Between neighbouring nodes the curve is a cubic with the slopes of the parabola through three nodes (Catmull and Rom's,
for unequal distances): once continuously differentiable, through all nodes, and linear in their positions. With the
position ``c(s)`` of its nearest point, outward unit normal n and unit tangent tau, a point x has

    g = n . (x - c),   dg = n . (dx - dc),
    d2g = [ -k dt dt + l (dt dm + dm dt) - g dm dm ] / a,   dt = tau . (dx - dc),  dm = -n . dc',
                                                            l = |c'|,  k = n . c'',  a = l^2 - g k

(the second derivative of half the squared distance, less dg dg, over g): no difference of small numbers at g = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.discrete.domain import FloatArray, IntArray

_ITERATIONS = 12
# The nearest point is found when the connecting line is square to the curve to this, mm.
_SQUARE_MM = 1e-10
# Cubic Hermite basis: rows are powers of the parameter, columns value and slope at both ends.
_HERMITE = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-3.0, -2.0, 3.0, -1.0], [2.0, 1.0, -2.0, 1.0]])


@dataclass(frozen=True)
class Near:
    """Nearest points of a curve to some points, and the derivatives of the gaps.

    Attributes
    ----------
    found
        Whether the point has a nearest one inside the curve, shape (n,). What follows holds only there.
    gap
        Along the outward normal, mm, shape (n,).
    nodes
        Places on the curve's line that the gap depends on, shape (n, 4); repeated at the ends, with zero weights.
    normal, along
        ``n`` and ``tau``, shape (n, 2).
    weight, slope
        Weights of the four nodes in c and in c', shape (n, 4).
    l, k, a
        As in the module's heading, shape (n,).
    """

    found: np.ndarray
    gap: FloatArray
    nodes: IntArray
    normal: FloatArray
    along: FloatArray
    weight: FloatArray
    slope: FloatArray
    l: FloatArray  # noqa: E741
    k: FloatArray
    a: FloatArray


class Curve:
    """The curve through a line's nodes.

    Parameters
    ----------
    rest
        Undeformed positions of the nodes in order, shape (n, 2), mm: their distances are the curve's parameter.
    side
        +1 or -1: the outward normal is ``side`` times the tangent turned by a quarter to the left.
    """

    def __init__(self, rest: FloatArray, side: float) -> None:
        self.side, self.count = side, len(rest)
        h = np.linalg.norm(np.diff(rest, axis=0), axis=1)
        slope = np.zeros((self.count, 3))  # weights of the nodes before, at and after in the slope at a node
        before, after = h[:-1], h[1:]
        low, high = after / (before + after), before / (before + after)
        slope[1:-1] = np.column_stack([-low / before, low / before - high / after, high / after])
        slope[0, 1:], slope[-1, :2] = [-1.0 / h[0], 1.0 / h[0]], [-1.0 / h[-1], 1.0 / h[-1]]
        ends = np.zeros((self.count - 1, 4, 4))  # value and slope at both ends, from four nodes
        ends[:, 0, 1] = ends[:, 2, 2] = 1.0
        ends[:, 1, :3] = h[:, None] * slope[:-1]
        ends[:, 3, 1:] = h[:, None] * slope[1:]
        self._powers = np.einsum("kj,sja->ska", _HERMITE, ends)
        self._nodes = np.clip(np.arange(self.count - 1)[:, None] + np.arange(-1, 3), 0, self.count - 1)

    def _weights(self, at: FloatArray) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
        """Segment, and the weights of its four nodes in c, c' and c''."""
        segment = np.clip(at.astype(np.int64), 0, self.count - 2)
        t = at - segment
        one, zero = np.ones_like(t), np.zeros_like(t)
        basis = np.stack([one, t, t**2, t**3], axis=1)
        first = np.stack([zero, one, 2.0 * t, 3.0 * t**2], axis=1)
        second = np.stack([zero, zero, 2.0 * one, 6.0 * t], axis=1)
        powers = self._powers[segment]
        weight, slope, bend = (np.einsum("nk,nka->na", b, powers) for b in (basis, first, second))
        return segment, weight, slope, bend

    def nearest(self, line: FloatArray, points: FloatArray, start: IntArray) -> Near:
        """Nearest points by Newton's method from given nodes.

        Parameters
        ----------
        line
            Deformed positions of the nodes, shape (count, 2), mm.
        points
            Shape (n, 2), mm.
        start
            Node near which to look for each point, shape (n,).
        """
        at = start.astype(float)
        for _ in range(_ITERATIONS):
            segment, weight, slope, bend = self._weights(at)
            nodes = line[self._nodes[segment]]
            v = points - np.einsum("na,nai->ni", weight, nodes)
            c1, c2 = np.einsum("na,nai->ni", slope, nodes), np.einsum("na,nai->ni", bend, nodes)
            l2 = np.einsum("ni,ni->n", c1, c1)
            fall = np.einsum("ni,ni->n", v, c1)
            stiff = l2 - np.einsum("ni,ni->n", v, c2)
            with np.errstate(invalid="ignore", divide="ignore"):  # a line crushed to a point has no tangent
                step = fall / np.where(stiff > 0.3 * l2, stiff, l2)
            new = np.clip(at + np.clip(step, -0.7, 0.7), 0.0, self.count - 1.0)
            if np.abs(new - at).max(initial=0.0) < 1e-11:
                break
            at = new
        length = np.sqrt(l2)
        with np.errstate(invalid="ignore", divide="ignore"):  # and nothing is found near it: NaN is not above 0
            tau = c1 / length[:, None]
        normal = self.side * np.column_stack([-tau[:, 1], tau[:, 0]])
        gap = np.einsum("ni,ni->n", v, normal)
        k = np.einsum("ni,ni->n", normal, c2)
        a = l2 - gap * k
        found = (np.abs(fall) <= _SQUARE_MM * length) & (a > 0.0) & (at > 0.0) & (at < self.count - 1.0)
        return Near(found, gap, self._nodes[segment], normal, tau, weight, slope, length, k, a)
