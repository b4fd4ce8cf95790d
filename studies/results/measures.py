"""The closed form's assumptions, measured in the axisymmetric states of a scene.

What a state is measured for, and what the closed form (`analytical.chains`, corrected chain) says of the same:

============================  ====  ===================================================================================
``root_stretch_outer``        1     hoop stretch of the roots' outside at their throat; the model's lambda_y
``root_stretch_inner``        1     the same on the cavity side
``root_bulge_mm``             mm    outward displacement of the roots' outside at their throat
``wall_stretch``              1     deformed over undeformed length of the side wall; the model's lambda_a, see `Places`
``unfolding_share``           1     share of the elongation that the side walls would give if they kept their length
``wall_hoop_stretch_middle``  1     hoop stretch half-way along the side wall; the model's pure shear says 1
``ring_hoop_stretch``         1     hoop stretch of the wall under the rings; the model says 1
``peak_stretch``              1     largest principal stretch of the silicone; the model's is that of root or side wall
``peak_stretch_away``         1     the same without what is near the edges of the seats, where corners may be singular
``cavity_volume_ratio``       1     volume of the cavity over that at rest
``peak_slip_mm``              mm    largest slip of the bond between wall and rigid rings; the model has none
``unfolding_kpa``             kPa   pressure at which the roots' outside is as far out as the crests'
============================  ====  ===================================================================================

Stretches of the wall are those of its mid-surface. All but the peaks are means over all roots, sides or seats.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshes.cells import CellKind, CellShape
from meshes.meridian import Band, bellows_band, default_resolution
from meshes.solid import REGIONS, FloatArray, IntArray
from meshes.strip.places import interpolation
from solvers.state import State
from studies.scene.bellows import BellowsScene, in_hexahedra, shape_of
from studies.scene.meshes import scene_meridian

UNITS = {
    "root_stretch_outer": "1",
    "root_stretch_inner": "1",
    "root_bulge_mm": "mm",
    "wall_stretch": "1",
    "unfolding_share": "1",
    "wall_hoop_stretch_middle": "1",
    "ring_hoop_stretch": "1",
    "peak_stretch": "1",
    "peak_stretch_away": "1",
    "cavity_volume_ratio": "1",
    "peak_slip_mm": "mm",
}
# Nearer to a seat's edge, on the outside, a peak may be that of a singular corner.
NEAR_EDGE_MM = 0.5


@dataclass(frozen=True)
class Places:
    """Places of a scene's meridian at which its states are measured: its mesh's nodes, then others within its cells.

    Attributes
    ----------
    points
        Where they are, mm.
    nodes
        Number of the mesh's nodes, which come first.
    between, weights
        Of the other places: nodes of the cell, and their weights, both (places, nodes of a cell).
    cells
        Those of the mesh that are silicone.
    cell
        Their reference cell.
    throats_outside, throats_inside
        The roots at their smallest radius, shape (n,).
    sides
        Mid-surface of each side wall in order, shape (2 n, s): from the edge of the ring's seat (the
        crest's middle where there are no rings) along the crest's arc, the straight side and the root's arc to the
        throat, or back. The model's side runs straight from crest to root and has no arcs.
    seats_middle, seats_outside
        Mid-surface and outside under each ring in order, shape (n + 1, s); s = 0 without rings.
    cavity
        The cavity's surface from the inlet to the axis of the cap or to the open end, shape (c,).
    near_edge
        True within ``NEAR_EDGE_MM`` of an outer edge of a seat, shape (nodes,); of the mesh's nodes only.
    band
        Stations along the outline, which know the part of the wall they belong to.
    """

    points: FloatArray
    nodes: int
    between: IntArray
    weights: FloatArray
    cells: IntArray
    cell: CellShape
    throats_outside: IntArray
    throats_inside: IntArray
    sides: IntArray
    seats_middle: IntArray
    seats_outside: IntArray
    cavity: IntArray
    near_edge: NDArray[np.bool_]
    band: Band

    def displacement_mm(self, at_nodes_mm: FloatArray) -> FloatArray:
        """Displacement of all places from that of the mesh's nodes."""
        return np.vstack([at_nodes_mm, np.einsum("pk,pkd->pd", self.weights, at_nodes_mm[self.between])])

    def part(self, node: int) -> str:
        """Where in the silicone a node is: root, side, crest, seat, collar or cap, and near which surface."""
        band = self.band
        lines = np.stack([band.inner, 0.5 * (band.inner + band.outer), band.outer])
        distance = np.linalg.norm(lines - self.points[node], axis=-1)
        depth, station = np.unravel_index(np.argmin(distance), distance.shape)
        kind = band.kinds[min(int(station) // 2, len(band.kinds) - 1)]
        return f"{'cap' if kind == 'corner' else kind}, {('cavity side', 'middle', 'outside')[depth]}"


def find_places(scene: BellowsScene, refinement: int) -> Places:
    """Mesh the meridian of a scene at a refinement and find the places in it."""
    shape, mesh = shape_of(scene), scene_meridian(scene, refinement)
    cells: CellKind = "quadrilaterals" if in_hexahedra(scene) else "triangles"
    band = bellows_band(shape, default_resolution(shape, refinement, cells))
    stations = np.arange(len(band.inner)) / (2.0 * refinement)
    across = np.repeat([0.0, 0.5 * mesh.strip[:, 1].max(), mesh.strip[:, 1].max()], len(stations))
    wanted = np.column_stack([np.tile(stations, 3), across])
    away, found = cKDTree(mesh.strip).query(wanted)
    other = away > 1e-9
    between, weights = interpolation(mesh, wanted[other])
    found[other] = len(mesh.points) + np.arange(other.sum())
    inside, middle, outside = found.reshape(3, -1)
    points = np.vstack([mesh.points, np.einsum("pk,pkd->pd", weights, mesh.points[between])])
    roots = np.array([_stations(band, "root", k) for k in range(shape.convolutions)])
    half_root = roots.shape[1] // 2
    throats = roots[:, half_root]
    # A fold is the same forwards and backwards. The arc at a crest has as many stations as half a root; a straight
    # side has two per interval, and the fold two sides.
    length = 2 * half_root + len(_intervals(band, "side", 0))
    along = np.arange(length + 1)
    sides = np.vstack([throats[:, None] - length + along, throats[:, None] + along])
    seats = np.empty((0, 0), dtype=np.int64)
    if scene.rings.model != "none":
        seats = np.array([_stations(band, "seat", k) for k in range(shape.convolutions + 1)])
    edges = np.concatenate([seats[:, :1], seats[:, -1:]])
    away = np.linalg.norm(mesh.points - band.outer[edges].reshape(-1, 1, 2), axis=2)
    return Places(
        points=points,
        nodes=len(mesh.points),
        between=between,
        weights=weights,
        cells=mesh.cells[mesh.regions != REGIONS["ring"]],
        cell=mesh.cell,
        throats_outside=outside[throats],
        throats_inside=inside[throats],
        sides=middle[sides],
        seats_middle=middle[seats],
        seats_outside=outside[seats],
        cavity=inside,
        near_edge=(away < NEAR_EDGE_MM).any(axis=0),
        band=band,
    )


def _intervals(band: Band, kind: str, number: int) -> list[int]:
    return [k for k, piece in enumerate(zip(band.kinds, band.index, strict=True)) if piece == (kind, number)]


def _stations(band: Band, kind: str, number: int) -> IntArray:
    """Stations of the adjoining intervals of a kind and a number, both ends included."""
    found = _intervals(band, kind, number)
    return np.arange(2 * found[0], 2 * found[-1] + 3)


@dataclass(frozen=True)
class Measured:
    """What a state was measured for: values by the names in ``UNITS``, and where each peak is."""

    values: Mapping[str, float]
    peak_in: Mapping[str, str]


def measure(scene: BellowsScene, places: Places, state: State) -> Measured:
    """Measure an axisymmetric state; what a scene without (rigid) rings does not have is left out."""
    u = places.displacement_mm(state.displacement_mm)
    hoop = hoop_stretches(places.points, u)
    middle = places.sides[:, places.sides.shape[1] // 2]
    lengths = [curve_length(x[places.sides]) for x in (places.points + u, places.points)]
    values = {
        "root_stretch_outer": hoop[places.throats_outside].mean(),
        "root_stretch_inner": hoop[places.throats_inside].mean(),
        "root_bulge_mm": u[places.throats_outside, 0].mean(),
        "wall_stretch": (lengths[0] / lengths[1]).mean(),
        "wall_hoop_stretch_middle": hoop[middle].mean(),
        "cavity_volume_ratio": cavity_volume(places.points[places.cavity] + u[places.cavity])
        / cavity_volume(places.points[places.cavity]),
    }
    if not scene.blocked:
        values["unfolding_share"] = unfolding_share(places.points[places.sides], (places.points + u)[places.sides])
    stretch = largest_stretches(places, state.displacement_mm)
    peaks = {"peak_stretch": int(np.argmax(stretch))}
    if places.seats_middle.size:
        values["ring_hoop_stretch"] = mean_along(hoop[places.seats_middle]).mean()
        peaks["peak_stretch_away"] = int(np.argmax(np.where(places.near_edge, 0.0, stretch)))
    if scene.rings.model == "rigid":
        # a rigid plate at the tip is one more body, after the rings
        ring = state.bodies_mm[: len(places.seats_outside), :1]
        slip = np.hypot(u[places.seats_outside, 0], u[places.seats_outside, 1] - ring)
        values["peak_slip_mm"] = slip.max()
    values |= {name: stretch[node] for name, node in peaks.items()}
    return Measured(
        {name: float(value) for name, value in values.items()},
        {name: places.part(node) for name, node in peaks.items()},
    )


def unfolding_share(before: FloatArray, after: FloatArray) -> float:
    """Share of side walls' elongation that is left if they have the shape that they have, in the length of rest.

    Each wall is shrunk as a whole, by its mean stretch. Above 1 where the walls have become shorter, NaN without
    elongation.

    Parameters
    ----------
    before, after
        Mid-surfaces at rest and deformed as for `curve_length`, columns r and z, shape (walls, s, 2), mm.
    """
    stretch = curve_length(after) / curve_length(before)
    rest, now = (walls[:, -1, 1] - walls[:, 0, 1] for walls in (before, after))
    gain = float((now - rest).sum())
    return float((now / stretch - rest).sum()) / gain if gain else math.nan


def cavity_volume(points: FloatArray) -> float:
    """Volume inside a line (r, z) that is turned about the axis, straight between its points, mm3."""
    r, z = points.T
    return float(math.pi / 3.0 * ((r[:-1] ** 2 + r[:-1] * r[1:] + r[1:] ** 2) * np.diff(z)).sum())


def hoop_stretches(points: FloatArray, displacement_mm: FloatArray) -> FloatArray:
    """Hoop stretch at nodes, shape (nodes,); 0 on the axis, where it is the radial one."""
    radius = points[:, 0]
    return np.divide(radius + displacement_mm[:, 0], radius, out=np.zeros(len(points)), where=radius > 0.0)


def largest_stretches(places: Places, displacement_mm: FloatArray) -> FloatArray:
    """Largest principal stretch at the nodes of the silicone, shape (nodes,); 0 at nodes of the rings alone.

    In the meridian plane, of the mean of the right Cauchy-Green tensors of the cells at a node.
    """
    cells, rest = places.cells, places.points[: places.nodes]
    slopes = places.cell.shape(places.cell.nodes)[1]
    before, after = (  # derivatives of the positions in the reference cell, shape (cells, nodes of a cell, 2, 2)
        np.moveaxis(np.tensordot(x[cells], slopes, (1, 1)), 1, 2) for x in (rest, rest + displacement_mm)
    )
    # by Cramer's rule: numpy's inverse of a hundred thousand 2 x 2 matrices takes twenty times as long
    a, b, c, d = before[..., 0, 0], before[..., 0, 1], before[..., 1, 0], before[..., 1, 1]
    inverse = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    gradient = after @ (inverse / (a * d - b * c)[..., None, None])
    tensor = np.swapaxes(gradient, -1, -2) @ gradient
    at, count = cells.ravel(), places.nodes
    share = np.maximum(np.bincount(at, minlength=count), 1)
    rr, rz, zz = (
        np.bincount(at, weights=tensor[..., i, j].ravel(), minlength=count) / share for i, j in ((0, 0), (0, 1), (1, 1))
    )
    in_plane = np.sqrt(0.5 * (rr + zz) + np.hypot(0.5 * (rr - zz), rz))
    hoop = np.zeros(count)
    silicone = np.unique(at)
    hoop[silicone] = hoop_stretches(rest, displacement_mm)[silicone]
    return np.maximum(in_plane, hoop)


def curve_length(points: FloatArray) -> FloatArray:
    """Length of curves of parabolas through each three nodes (corner, middle, corner, ...).

    Parameters
    ----------
    points
        Shape (..., 2 m + 1, 2), mm.

    Returns
    -------
    ndarray
        Shape (...), mm.
    """
    a, b, c = (points[..., k : points.shape[-2] - 2 + k : 2, None, :] for k in range(3))
    x, weight = np.polynomial.legendre.leggauss(4)
    s = 0.5 * (x[:, None] + 1.0)
    tangent = (4.0 * s - 3.0) * a + (4.0 - 8.0 * s) * b + (4.0 * s - 1.0) * c
    return np.asarray((np.linalg.norm(tangent, axis=-1) @ (0.5 * weight)).sum(axis=-1))


def mean_along(values: FloatArray) -> FloatArray:
    """Mean along lines of equally long quadratic pieces, shape (..., 2 m + 1) -> (...)."""
    return np.asarray((values[..., :-2:2] + 4.0 * values[..., 1:-1:2] + values[..., 2::2]).mean(axis=-1) / 6.0)
