"""A thin inextensible ring under follower pressure beyond buckling into two waves: the plane elastica, integrated.

With the arc length s in units of the radius R of the ring, curvature k in 1/R and q = P R^3 / (E' I), the balance of
forces and moments of a bent line under a normal pressure has the first integral

    k'' = -k^3 / 2 + c k + q,    theta' = k,

with a constant c (Carrier, J. Math. Phys. 26 (1947) 94; Tadjbakhsh and Odeh, J. Math. Anal. Appl. 18 (1967) 59). A
quarter between two axes of symmetry has k' = 0 at both ends and turns by pi / 2. The circle, k = 1 and c = 1/2 - q,
bends into k = 1 + a cos(n s) where n^2 = q + 1, so into two waves at q = 3. From there q rises, as 3 (1 + 27/32 d^2)
with small moves d of the axes.
Units: lengths in R, pressures in E' I / R^3, with E' I = mu t^3 / 3 for an incompressible ring in plane strain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import simpson, solve_bvp

# Where the circle buckles into two waves.
CRITICAL_LOAD = 3.0
# Half the ring is closed, its sides touching, at an outward move of about 0.36.
LARGEST_MOVE = 0.35
_NODES, _TOLERANCE, _SIMPSON = 41, 1e-9, 401


class ElasticaError(ValueError):
    """A bent ring that cannot be had; the message names value and remedy."""


@dataclass(frozen=True)
class BentRing:
    """A ring bent into two waves.

    Parameters
    ----------
    load
        q = P R^3 / (E' I).
    outward, inward
        Moves of the two axes of symmetry, in R, both positive.
    energy, area
        Bending energy of the whole ring, E' I / R, and area it encloses, R^2. Along the branch dU = -q dA.
    """

    load: float
    outward: float
    inward: float
    energy: float
    area: float


def bent_ring(outward: float) -> BentRing:
    """The ring whose long axis has moved out by so much of the radius.

    Parameters
    ----------
    outward
        0 < outward <= 0.35.

    Raises
    ------
    ElasticaError
        Outside this range, or if the integration fails.
    """
    if not 0.0 < outward <= LARGEST_MOVE:
        raise ElasticaError(f"outward move = {outward:g} of the radius: must be > 0 and at most {LARGEST_MOVE:g}")

    def slopes(_: NDArray[np.float64], y: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
        theta, k, bend = y[0], y[1], y[2]
        return np.vstack([k, bend, -0.5 * k**3 + p[0] * k + p[1], -np.sin(theta), np.cos(theta)])

    def ends(a: NDArray[np.float64], b: NDArray[np.float64], _: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([a[0], a[2], b[0] - 0.5 * math.pi, b[2], a[3] - 1.0 - outward, b[3], a[4]])

    s = np.linspace(0.0, 0.5 * math.pi, _NODES)
    bump = 3.0 * outward * np.cos(2.0 * s)
    first = np.vstack(
        [
            s + 1.5 * outward * np.sin(2.0 * s),
            1.0 + bump,
            -6.0 * outward * np.sin(2.0 * s),
            (1.0 + outward * np.cos(2.0 * s)) * np.cos(s),
            (1.0 + outward * np.cos(2.0 * s)) * np.sin(s),
        ]
    )
    found = solve_bvp(slopes, ends, s, first, p=[0.5 - CRITICAL_LOAD, CRITICAL_LOAD], tol=_TOLERANCE, max_nodes=20000)
    if not found.success:
        raise ElasticaError(f"outward move = {outward:g} of the radius: no bent ring found ({found.message})")
    s = np.linspace(0.0, 0.5 * math.pi, _SIMPSON)
    theta, k, _, x, y = found.sol(s)
    energy, area = 4.0 * simpson(0.5 * (k - 1.0) ** 2, x=s), 4.0 * simpson(x * np.cos(theta), x=s)
    return BentRing(float(found.p[1]), outward, float(1.0 - y[-1]), float(energy), float(area))
