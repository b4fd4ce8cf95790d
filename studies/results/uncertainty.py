"""Discretisation uncertainty from three meshes (grid convergence index).

The error of a quantity is taken as ``C h^q``. Three meshes give q and the limit; the uncertainty is 1.25 times
the distance to the limit, or 3 times it with the nominal order where the three values are not monotone or their
order is off by half (Roache, J. Fluids Eng. 1994, doi 10.1115/1.2910291). Values that are not monotone may be near each
other by accident, so then it is their range at least (after Eça and Hoekstra, J. Comput. Phys. 2014, doi
10.1016/j.jcp.2014.01.006, who take three times it).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

SAFETY, SAFETY_IN_DOUBT = 1.25, 3.0


@dataclass(frozen=True)
class Convergence:
    """Three values on three meshes and what they say.

    Attributes
    ----------
    limit
        Extrapolated value.
    order
        Order used: the observed one, or the nominal one in doubt.
    safety
        1.25, or 3 in doubt.
    least
        The uncertainty is not less than this, in the unit of the values.
    """

    limit: float
    order: float
    safety: float
    least: float = 0.0

    def uncertainty(self, value: float) -> float:
        """Uncertainty of a value on one of the meshes, in its unit."""
        found = self.safety * abs(value - self.limit)
        return self.least if found < self.least else found


def convergence(sizes: Sequence[float], values: Sequence[float], nominal_order: float) -> Convergence:
    """Convergence of a quantity on three meshes.

    Parameters
    ----------
    sizes
        Cell sizes in any unit, coarsest first, strictly descending.
    values
        The quantity on each.
    nominal_order
        Order to expect.

    Returns
    -------
    Convergence
    """
    (h1, h2, h3), (f1, f2, f3) = sizes, values

    def ratio(q: float) -> float:
        return (h1**q - h2**q) / (h2**q - h3**q)

    def limit(q: float) -> float:
        return f3 - (f2 - f3) * h3**q / (h2**q - h3**q)

    if f2 != f3 and (f1 - f2) / (f2 - f3) > 0.0:
        wanted = (f1 - f2) / (f2 - f3)
        low, high = 0.5 * nominal_order, 1.5 * nominal_order
        if ratio(low) <= wanted <= ratio(high):
            for _ in range(100):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if ratio(middle) < wanted else (low, middle)
            return Convergence(limit(low), low, SAFETY)
    monotone = min(f1, f3) <= f2 <= max(f1, f3)
    least = 0.0 if monotone else max(values) - min(values)
    return Convergence(limit(nominal_order), nominal_order, SAFETY_IN_DOUBT, least)


def from_two(sizes: Sequence[float], values: Sequence[float], nominal_order: float) -> Convergence:
    """As `convergence`, from two meshes with the nominal order and the larger safety factor."""
    (h1, h2), (f1, f2) = sizes, values
    share = h2**nominal_order / (h1**nominal_order - h2**nominal_order)
    return Convergence(f2 - (f1 - f2) * share, nominal_order, SAFETY_IN_DOUBT)


UNKNOWN = Convergence(math.nan, math.nan, math.nan)
