"""A body whose moulding core sat off the axis: the cavity moved sideways against the outside.

With the core shifted by d along x, a wall whose normal has the radial part n_r at the angle theta from x is
t - d n_r cos(theta): one along the axis goes as t (1 - e cos(theta)), e = d / t, and one across the axis keeps its
thickness. The cavity's surface moves as a whole and the outside stays, so cavity and solid keep their volumes. Nodes in
between move by their share of the way through the wall.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from meshes.errors import GeometryError
from meshes.gaps import outlines
from meshes.quality import jacobians
from meshes.revolve import revolve_scalar
from meshes.solid import REGIONS, FloatArray, SolidMesh


def shift_core(body: SolidMesh, meridian: SolidMesh, shift_mm: float) -> SolidMesh:
    """Move the cavity of a body of revolution along x.

    Parameters
    ----------
    body
        The whole circle, made from the meridian by `meshes.revolve.revolve` or `meshes.sweep.revolve_hexahedra`.
    meridian
        Its meridian, without rings.
    shift_mm
        How far the core sits off the axis, mm.

    Returns
    -------
    SolidMesh
        The same cells on other points; ``meridian_node`` and ``angle_rad`` say where nodes came from.

    Raises
    ------
    GeometryError
        If rings are meshed, or a cell folds over.
    """
    if (meridian.regions == REGIONS["ring"]).any():
        raise GeometryError("an eccentric core with meshed rings: take rigid ones")
    share = revolve_scalar(share_of_wall(meridian), body)
    points = body.points.copy()
    points[:, 0] += shift_mm * share
    before, after = (jacobians(p, body.cells) for p in (body.points, points))
    if (before * after <= 0.0).any():
        worst = body.cells[int(np.argmin((before * after).min(axis=1)))]
        x, y, z = points[worst].mean(axis=0)
        raise GeometryError(
            f"core shifted by {shift_mm:g} mm: a cell at x = {x:.3g}, y = {y:.3g}, z = {z:.3g} mm folds over; "
            "shift it less"
        )
    return dataclasses.replace(body, points=points)


def share_of_wall(meridian: SolidMesh) -> FloatArray:
    """Where nodes are within the wall: 1 on the cavity's side, 0 on the outside, shape (nodes,).

    By their distances from the two outlines, which in a wall of parallel sides is linear through it.
    """
    inner, outer = (outline.nodes for outline in outlines(meridian))
    from_cavity, from_outside = (_distance(meridian.points, meridian.points[line]) for line in (inner, outer))
    share = from_outside / (from_cavity + from_outside)
    share[inner], share[outer] = 1.0, 0.0
    return share


def _distance(points: FloatArray, line: FloatArray) -> FloatArray:
    """Distance of points from a polyline, shape (points,)."""
    nearest = np.full(len(points), np.inf)
    for start, end in zip(line[:-1], line[1:], strict=True):
        along = end - start
        at = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(points - start - at[:, None] * along, axis=1))
    return nearest
