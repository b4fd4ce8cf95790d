"""Discretisation uncertainty from two or three meshes.

Two cases, told apart by the `Orders` to expect.

*Smooth*: the error of a quantity is taken as ``C h^q``. Three meshes give q and the limit; the uncertainty is 1.25
times the distance to the limit, or 3 times it where the three values are not monotone or their order is off by half,
then with the lower of the observed and the expected order (Roache, J. Fluids Eng. 1994, doi 10.1115/1.2910291). Values
that are not monotone may be near each other by accident, so then it is their range at least (after Eça and Hoekstra,
J. Comput. Phys. 2014, doi 10.1016/j.jcp.2014.01.006, who take three times it); and where their differences do not fall,
there is no limit to be told, and it is three times the range.

*With a singular edge*: the error is ``a h^p + b h^q``, p of the edge and q of the smooth rest, both known (Eça and
Hoekstra, too, take two powers where one fits badly). The parts have either sign, and where they cancel the observed
order is anything: the limit is by the observed order, kept between p and q, and by a fit of both powers where there is
none that could be believed. The limit's own doubt is its distance from the finest mesh or from that fit, the larger, or
what an edge would leave if all of the change were its own; the uncertainty of a mesh is its distance to the limit and
that doubt. Of two meshes the limit is midway between those by either order, and the doubt the whole error by the lower
one; as an answer it would be no better than the finest mesh. How often that holds is audited: docs/decisions.md,
"Uncertainty of two and of three meshes".

The order of an edge. Where a rigid part is bonded to an incompressible solid and its bond ends at a free surface,
stress goes as ``r^(lambda - 1)`` with ``cos(lambda angle) = lambda sin(angle)`` (Williams, J. Appl. Mech. 1952,
doi 10.1115/1.4010553, clamped and free face, nu = 1/2): lambda = 1/2 where the free surface goes on from the bond
without a corner, as beside a seat, and 0.595 where it meets it at a right angle, as at a clamped end. An energy, and by
duality any smooth functional such as a tip's displacement, converges with ``2 lambda``: orders 1 and 1.19, of which the
lower one is taken. Without singularities quadratic elements give 3 or more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SAFETY, SAFETY_IN_DOUBT = 1.25, 3.0
# Orders that are observed to be lower are counted as this one, or not believed: by less any limit would do (Oberkampf
# and Roy, Verification and Validation in Scientific Computing, 2010, section 8.6.3).
LOWEST_ORDER = 0.5
# Twice 1/2: see above.
EDGE_ORDER = 1.0


@dataclass(frozen=True)
class Orders:
    """Orders of convergence to expect: of the smooth part of the error, and of a singular edge if there is one."""

    smooth: float
    edge: float | None = None


@dataclass(frozen=True)
class Convergence:
    """What several meshes say of a quantity.

    Attributes
    ----------
    limit
        Extrapolated value.
    safety
        By how much the distance to the limit is multiplied.
    doubt
        What is added to that for the limit itself, in the unit of the values.
    least
        The uncertainty is not less than this, in the unit of the values.
    of_limit
        Uncertainty of the limit itself; NaN where that is no better than the value on the finest mesh.
    """

    limit: float
    safety: float = 1.0
    doubt: float = 0.0
    least: float = 0.0
    of_limit: float = math.nan

    def uncertainty(self, value: float) -> float:
        """Uncertainty of a value on one of the meshes, in its unit."""
        found = self.safety * abs(value - self.limit) + self.doubt
        return self.least if found < self.least else found


UNKNOWN = Convergence(math.nan)


def convergence(
    sizes: Sequence[float], values: Sequence[float], orders: Orders, left_by_edge: float | None = None
) -> Convergence:
    """Convergence of a quantity on two or three meshes; on one it is unknown.

    Parameters
    ----------
    sizes
        Cell sizes in any unit, coarsest first, strictly descending.
    values
        The quantity on each.
    orders
        Orders to expect.
    left_by_edge
        What an edge may leave of error on the last of three meshes, where more is known of it than by these values: of
        them it is `share_left` of the whole change.

    Returns
    -------
    Convergence
    """
    if len(values) < 2:
        return UNKNOWN
    if orders.edge is None:
        return (_smooth_of_three if len(values) == 3 else _smooth_of_two)(sizes, values, orders.smooth)
    if len(values) == 2:
        return _edge_of_two(sizes, values, orders.edge, orders.smooth)
    if left_by_edge is None:
        left_by_edge = abs(values[2] - values[0]) * share_left(sizes[::2], orders.edge)
    return _edge_of_three(sizes, values, orders.edge, orders.smooth, left_by_edge)


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """Order q of ``C h^q`` through three values, between 0.01 and 20; None if they are not monotone."""
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    if f2 == f3 or (f1 - f2) / (f2 - f3) <= 0.0:
        return None
    wanted = (f1 - f2) / (f2 - f3)
    low, high = 0.01, 20.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        found = (h1**middle - h2**middle) / (h2**middle - h3**middle)
        low, high = (middle, high) if found < wanted else (low, middle)
    return low


def extrapolated(sizes: Sequence[float], values: Sequence[float], order: float) -> float:
    """Limit by the last two values and an order."""
    return values[-1] + (values[-1] - values[-2]) * share_left(sizes, order)


def share_left(sizes: Sequence[float], order: float) -> float:
    """Error of the last of these meshes over its difference from the last but one, of one order."""
    return float(sizes[-1] ** order / (sizes[-2] ** order - sizes[-1] ** order))


def _smooth_of_three(sizes: Sequence[float], values: Sequence[float], nominal: float) -> Convergence:
    """By the observed order where it is near the nominal one; else in doubt, by the lower of the two orders.

    Differences that do not fall with the cells tell of no limit: three times their range at least.
    """
    order, last, change = observed_order(sizes, values), values[2] - values[1], values[1] - values[0]
    if order is not None and 0.5 * nominal <= order <= 1.5 * nominal:
        return Convergence(extrapolated(sizes, values, order), SAFETY)
    used = nominal if order is None else min(max(order, LOWEST_ORDER), nominal)
    least = 0.0 if order is not None else max(values) - min(values)
    if abs(last) >= abs(change):
        least = SAFETY_IN_DOUBT * (max(values) - min(values))
    return Convergence(extrapolated(sizes, values, used), SAFETY_IN_DOUBT, least=least)


def _smooth_of_two(sizes: Sequence[float], values: Sequence[float], nominal: float) -> Convergence:
    return Convergence(extrapolated(sizes, values, nominal), SAFETY_IN_DOUBT)


def _edge_of_three(
    sizes: Sequence[float], values: Sequence[float], edge: float, smooth: float, left_by_edge: float
) -> Convergence:
    """By the observed order within both, beside a fit of two powers.

    The doubt is at least what the smooth part alone would leave.
    """
    powers = np.array([[1.0, h**edge, h**smooth] for h in sizes])
    limit = of_both = float(np.linalg.solve(powers, np.asarray(values))[0])
    order = observed_order(sizes, values)
    if order is not None and order >= LOWEST_ORDER:
        limit = extrapolated(sizes, values, min(max(order, edge), smooth))
    least = abs(values[2] - values[1]) * share_left(sizes, smooth)
    doubt = max(abs(values[2] - limit), abs(limit - of_both), least, left_by_edge)
    return Convergence(limit, doubt=doubt, of_limit=doubt)


def _edge_of_two(sizes: Sequence[float], values: Sequence[float], edge: float, smooth: float) -> Convergence:
    """Midway between the limits by either order; the doubt is the whole error by the lower one."""
    limit = 0.5 * (extrapolated(sizes, values, edge) + extrapolated(sizes, values, smooth))
    return Convergence(limit, doubt=abs(values[1] - values[0]) * share_left(sizes, edge))
