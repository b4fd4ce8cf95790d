"""What contact is between: lines of surface, rigid sections, bodies; the penalty; Gauss points of a line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.contact.obstacles import Obstacle
from solvers.discrete.domain import FloatArray, IntArray

# Gauss points of a facet: more than a facet's nodes, so that a facet partly in contact is seen to be.
_GAUSS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True)
class ContactSettings:
    """The penalty.

    Attributes
    ----------
    stiffness_mpa_per_mm
        k: pressure per depth.
    smoothing_mm
        d: the pressure begins at this gap.
    depth_mm
        Newton's iterations may take a line this deep into another before it is taken for its far side; less than the
        wall. In a rigid section any depth counts.
    reach_mm
        Pairs closer than this have a place in the sparse matrix, before they touch.
    limit_mm
        A state with a deeper penetration is not accepted; where contact fades out, with one that presses more.
    """

    stiffness_mpa_per_mm: float
    smoothing_mm: float
    depth_mm: float
    reach_mm: float
    limit_mm: float

    def pressure(self, gap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy per area, contact pressure and its fall with the gap, ``phi, -phi', phi''``."""
        k, d = self.stiffness_mpa_per_mm, self.smoothing_mm
        near = np.clip(d - gap, 0.0, 2.0 * d)
        deep = np.maximum(-d - gap, 0.0)  # beyond the parabola
        energy = k * near**3 / (12.0 * d) + k * d * deep + 0.5 * k * deep**2
        return energy, k * near**2 / (4.0 * d) + k * deep, np.where(deep > 0.0, k, 0.5 * k * near / d)


@dataclass(frozen=True)
class Line:
    """A stretch of surface that may touch.

    Attributes
    ----------
    nodes
        Caller's nodes in order, corner, mid-facet, corner, ..., shape (2 m + 1,).
    side
        +1 or -1: the outward normal is ``side`` times the tangent turned by a quarter to the left.
    free
        Facets that can touch; bonded ones cannot, shape (m,).
    """

    nodes: IntArray
    side: float
    free: np.ndarray


@dataclass(frozen=True)
class Against:
    """A line against a rigid section.

    Attributes
    ----------
    what
        Name of the pair in reports.
    line
        Number of the line.
    obstacle
        The section, where it is in the unloaded state.
    body
        Number of the rigid body that it moves with; None stands still.
    grade
        Factor on the pressure at each Gauss point of the line, shape (m, 5); empty is one everywhere.
    """

    what: str
    line: int
    obstacle: Obstacle
    body: int | None
    grade: FloatArray


@dataclass(frozen=True)
class Facing:
    """A line against a line, which may be the same."""

    what: str
    points: int
    curve: int


@dataclass(frozen=True)
class Stop:
    """Two rigid bodies whose flat faces meet: ``gap`` apart when unloaded, mm, with a common area, mm^2."""

    what: str
    lower: int
    upper: int
    gap_mm: float
    area_mm2: float


@dataclass(frozen=True)
class PairReport:
    """One kind of pair in a state.

    Attributes
    ----------
    what
        Name of the pair.
    gap_mm
        Smallest gap at Gauss points within reach, negative is penetration; infinite if there is none. Places where
        contact fades out count only while they carry.
    force_n
        Sum of contact pressure over the area in contact.
    places
        Gauss points with a contact pressure.
    """

    what: str
    gap_mm: float
    force_n: float
    places: int


class LinePoints:
    """Gauss points of a line's free facets.

    Parameters
    ----------
    line
        The line.
    rest, dofs
        Undeformed positions, mm, and dofs of its nodes, each of shape (2 m + 1, 2).
    """

    def __init__(self, line: Line, rest: FloatArray, dofs: IntArray) -> None:
        x = 0.5 * (1.0 + _GAUSS)
        shape = np.column_stack([(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)])
        slope = np.column_stack([4.0 * x - 3.0, 4.0 - 8.0 * x, 4.0 * x - 1.0])
        facets = np.flatnonzero(line.free)
        self.places = 2 * np.repeat(facets, len(x))[:, None] + np.arange(3)
        self.shape, self.slope = np.tile(shape, (len(facets), 1)), np.tile(slope, (len(facets), 1))
        at = np.einsum("qa,qai->qi", self.shape, rest[self.places])
        stretch = np.linalg.norm(np.einsum("qa,qai->qi", self.slope, rest[self.places]), axis=1)
        self.weight = 2.0 * np.pi * at[:, 0] * stretch * np.tile(0.5 * _GAUSS_WEIGHTS, len(facets))
        self.facets = facets
        self.is_middle = np.arange(len(at)) % len(x) == len(x) // 2
        self.middles = self.places[self.is_middle, 1]
        self.dofs = dofs[self.places].reshape(len(at), 6)

    def now(self, line: FloatArray) -> FloatArray:
        """Positions, from the line's nodes, shape (n, 2), mm."""
        return np.einsum("qa,qai->qi", self.shape, line[self.places])

    def normals(self, line: FloatArray, side: float) -> FloatArray:
        """Outward unit normals, shape (n, 2)."""
        t = np.einsum("qa,qai->qi", self.slope, line[self.places])
        return side * np.column_stack([-t[:, 1], t[:, 0]]) / np.linalg.norm(t, axis=1)[:, None]


def gauss_points(points: FloatArray, nodes: IntArray) -> FloatArray:
    """Undeformed positions of all Gauss points of a line, shape (m, 5, 2), for `Against.grade`."""
    x = 0.5 * (1.0 + _GAUSS)
    shape = np.column_stack([(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)])
    place = 2 * np.arange((len(nodes) - 1) // 2)[:, None] + np.arange(3)
    return np.asarray(np.einsum("qa,mai->mqi", shape, points[nodes][place]))
