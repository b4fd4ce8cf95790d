"""Cross-section of a ring, triangulated by gmsh in a child process.

gmsh 4.8 can abort the whole process on a bad outline; in a child that becomes an error message.
"""

from __future__ import annotations

import functools
import json
import math
import sys
from dataclasses import asdict, dataclass

import numpy as np

from meshes.by_gmsh.child import run_gmsh
from meshes.errors import GeometryError
from meshes.solid import FloatArray, IntArray


@dataclass(frozen=True)
class RingShape:
    """A ring of rectangular section on its seat, the two outer edges rounded; mm.

    Attributes
    ----------
    height_mm
        Radial height.
    edge_radius_mm
        Radius of the outer edges.
    cell_mm
        Size of triangles away from the seat.
    """

    height_mm: float
    edge_radius_mm: float
    cell_mm: float = 0.8


def check_ring(ring: RingShape, width_mm: float) -> None:
    """Refuse a section whose rounded edges do not fit it on a seat of a width.

    Raises
    ------
    GeometryError
        With the sizes.
    """
    if not (ring.height_mm > 0 and 0 <= ring.edge_radius_mm < min(ring.height_mm, 0.5 * width_mm)):
        raise GeometryError(
            f"ring edge_radius_mm = {ring.edge_radius_mm:g} must be >= 0 and less than the height "
            f"{ring.height_mm:g} mm and half the seat, {0.5 * width_mm:g} mm"
        )


def ring_triangles(ring: RingShape, seat_z: FloatArray, seat_radius_mm: float) -> tuple[FloatArray, IntArray]:
    """Triangulate a ring whose bonded edge has its corners exactly at the given positions.

    Parameters
    ----------
    seat_z
        Axial positions of the seat's corner nodes, ascending, mm, shape (k,).
    seat_radius_mm
        Radius of the seat.

    Returns
    -------
    points, cells
        (n, 2) positions (r, z) in mm and (m, 6) quadratic triangles in basix order.

    Raises
    ------
    GeometryError
        If the rounding does not fit the section.
    MeshError
        If gmsh fails; the message ends with what it printed.
    """
    check_ring(ring, float(seat_z[-1] - seat_z[0]))
    request = {**asdict(ring), "seat_z": list(map(float, seat_z)), "seat_radius_mm": seat_radius_mm}
    answer = json.loads(_meshed(json.dumps(request)))
    return np.array(answer["points"]), np.array(answer["cells"], dtype=np.int64)


@functools.lru_cache(maxsize=8)
def _meshed(request: str) -> str:
    """Answer of a child; a run's levels and what tells their errors ask for the same ring."""
    printed = run_gmsh("meshes.by_gmsh.ring", "gmsh could not mesh the ring section", text=request)
    return printed.splitlines()[-1]


def _mesh_in_this_process(request: dict) -> dict:
    import gmsh

    seat_z, radius = request["seat_z"], request["seat_radius_mm"]
    top, edge, size = radius + request["height_mm"], request["edge_radius_mm"], request["cell_mm"]
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo = gmsh.model.geo
    # gmsh x is r and gmsh y is z, as in the meridian mesh.
    seat = [geo.addPoint(radius, z, 0.0, size) for z in seat_z]
    low, high = seat_z[0], seat_z[-1]
    lines = [geo.addLine(a, b) for a, b in zip(seat[:-1], seat[1:], strict=True)]
    bonded = list(lines)
    if edge > 0.0:
        p = [
            geo.addPoint(top - edge, high, 0.0, size),
            geo.addPoint(top, high - edge, 0.0, size),
            geo.addPoint(top, low + edge, 0.0, size),
            geo.addPoint(top - edge, low, 0.0, size),
        ]
        centres = [geo.addPoint(top - edge, high - edge, 0.0), geo.addPoint(top - edge, low + edge, 0.0)]
        lines += [
            geo.addLine(seat[-1], p[0]),
            geo.addCircleArc(p[0], centres[0], p[1]),
            geo.addLine(p[1], p[2]),
            geo.addCircleArc(p[2], centres[1], p[3]),
            geo.addLine(p[3], seat[0]),
        ]
    else:
        p = [geo.addPoint(top, high, 0.0, size), geo.addPoint(top, low, 0.0, size)]
        lines += [geo.addLine(seat[-1], p[0]), geo.addLine(p[0], p[1]), geo.addLine(p[1], seat[0])]
    geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line in bonded:
        geo.mesh.setTransfiniteCurve(line, 2)
    geo.synchronize()
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(9)
    gmsh.finalize()
    if not len(nodes):
        raise RuntimeError("gmsh returned no triangles")
    place = {int(tag): k for k, tag in enumerate(tags)}
    cells = np.array([place[int(t)] for t in nodes]).reshape(-1, 6)
    used, back = np.unique(cells, return_inverse=True)
    points = np.asarray(coordinates).reshape(-1, 3)[used, :2]
    # gmsh orders mid-edge nodes 01, 12, 20; basix 12, 02, 01.
    cells = back.reshape(-1, 6)[:, [0, 1, 2, 4, 5, 3]]
    if not math.isfinite(float(points.sum())):
        raise RuntimeError("gmsh returned points that are not finite")
    return {"points": points.tolist(), "cells": cells.tolist()}


if __name__ == "__main__":
    print(json.dumps(_mesh_in_this_process(json.load(sys.stdin))))
