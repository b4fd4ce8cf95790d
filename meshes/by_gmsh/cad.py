"""A solid from CAD (STEP, IGES, BREP) or a closed STL: its numbered surfaces, and a mesh of it with named ones.

gmsh does both in a child process. It numbers the surfaces of a file the same way each time, so what was listed can be
named. Solids that touch are made to share what they touch in. The surface of an STL is cut into parts along its edges.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshes.by_gmsh.child import run_gmsh
from meshes.by_gmsh.stl import curve_cells, open_stl, read_pieces
from meshes.cells import FloatArray
from meshes.errors import MeshError

ENDINGS = (".step", ".stp", ".iges", ".igs", ".brep", ".stl")
# An STL's facets that meet at more than this are parts of two surfaces.
STL_ANGLE_DEG = 40.0
# Cells round a full circle, however large they may be elsewhere: parabolas of 30 degrees are off by 1e-4 of the radius.
ROUND = 12
# Cells of a picture's triangles along the longest edge of the box.
_PICTURE_CELLS = 25


@dataclass(frozen=True)
class Surface:
    """A surface of a solid.

    Attributes
    ----------
    number
        gmsh's.
    kind
        ``Plane``, ``Cylinder`` and so on; of an STL ``Discrete surface``.
    area_mm2, centre_mm, normal
        Area, centre of it, and its mean normal, which is shorter than 1 where it is curved.
    triangles
        A coarse picture of it, shape (n, 3, 3), mm.
    """

    number: int
    kind: str
    area_mm2: float
    centre_mm: tuple[float, float, float]
    normal: tuple[float, float, float]
    triangles: FloatArray


@dataclass(frozen=True)
class Solid:
    """The outer surfaces of what a file holds, and the volume inside them, mm^3."""

    surfaces: tuple[Surface, ...]
    volume_mm3: float


def read_solid(path: Path, scale: float = 1.0, angle_deg: float = STL_ANGLE_DEG) -> Solid:
    """Read a solid, coarsely.

    Parameters
    ----------
    path
        A file with one of ``ENDINGS``.
    scale
        Factor that makes its lengths mm; gmsh knows the units of STEP and IGES itself.
    angle_deg
        Of an STL: edges sharper than this part surfaces.

    Raises
    ------
    MeshError
        If there is no solid, or gmsh cannot read the file.
    """
    said = _ask({"path": str(path.resolve()), "angle_deg": angle_deg}, f"{path}: gmsh cannot read a solid from it")
    triangles = [scale * np.array(found["triangles"]).reshape(-1, 3, 3) for found in said["surfaces"]]
    every, surfaces = np.vstack(triangles), []
    for found, corners in zip(said["surfaces"], triangles, strict=True):
        if _points_inwards(corners, every):
            corners = corners[:, ::-1]
        areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(areas, axis=1)
        centre = (size[:, None] * corners.mean(axis=1)).sum(axis=0) / size.sum()
        normal = areas.sum(axis=0) / size.sum()
        x, y, z = centre.tolist()
        surfaces.append(
            Surface(found["number"], found["kind"], float(size.sum()), (x, y, z), tuple(normal.tolist()), corners)
        )
    if said["volume"] is not None:
        return Solid(tuple(surfaces), scale**3 * said["volume"])
    corners = np.vstack([surface.triangles for surface in surfaces])
    return Solid(tuple(surfaces), float(np.linalg.det(corners).sum()) / 6.0)


def mesh_solid(
    path: Path,
    out: Path,
    size_mm: float,
    names: Mapping[str, tuple[int, ...]],
    scale: float = 1.0,
    angle_deg: float = STL_ANGLE_DEG,
) -> None:
    """Mesh a solid in tetrahedra of second order and write it with its named surfaces, lengths in mm.

    Its volume is named ``body``; several become ``body_1``, ``body_2`` and so on.

    Parameters
    ----------
    path, scale, angle_deg
        As for `read_solid`.
    out
        The .msh to write.
    size_mm
        Largest edge of a cell.
    names
        Numbers of the surfaces of each name.

    Raises
    ------
    MeshError
        If gmsh fails.
    """
    job = {
        "path": str(path.resolve()),
        "angle_deg": angle_deg,
        "out": str(out.resolve()),
        "size": size_mm / scale,
        "scale": scale,
        "names": {name: list(numbers) for name, numbers in names.items()},
    }
    _ask(job, f"{path}: gmsh cannot mesh it with cells of {size_mm:g} mm")
    if not out.exists():
        raise MeshError(f"{path}: gmsh wrote no mesh")


def _points_inwards(corners: FloatArray, every: FloatArray) -> bool:
    """True if a surface's normal points into the solid: a ray from just before it leaves it an odd number of times."""
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    largest = int(np.linalg.norm(doubled, axis=1).argmax())
    normal = doubled[largest] / np.linalg.norm(doubled[largest])
    start = corners[largest].mean(axis=0) + 1e-4 * np.ptp(every.reshape(-1, 3), axis=0).max() * normal
    # u, v, t of start + t (ray) = a + u (b - a) + v (c - a), by Cramer's rule; the ray meets no edge by its odd slopes
    ray = normal + np.array([0.1234567, 0.0765432, 0.0456789])
    a, ab, ac = every[:, 0], every[:, 1] - every[:, 0], every[:, 2] - every[:, 0]
    across = np.cross(ray, ac)
    size = np.einsum("ij,ij->i", ab, across)
    size[size == 0.0] = np.nan  # along the ray
    off = start - a
    u = np.einsum("ij,ij->i", off, across) / size
    beside = np.cross(off, ab)
    v, t = beside @ ray / size, np.einsum("ij,ij->i", ac, beside) / size
    return bool(np.count_nonzero((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)) % 2)


def _ask(job: dict[str, Any], failed: str) -> dict[str, Any]:
    said: dict[str, Any] = json.loads(run_gmsh("meshes.by_gmsh.cad", failed, text=json.dumps(job)).splitlines()[-1])
    return said


# --- in the child ---------------------------------------------------------------------------------------------


def _in_this_process(job: dict[str, Any]) -> dict[str, Any]:
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    path, angle = job["path"], math.radians(job["angle_deg"])
    is_stl = path.lower().endswith(".stl")
    (open_stl if is_stl else _open_cad)(gmsh, path, angle)
    # a surface between two solids is no outer one
    outer = [tag for _, tag in gmsh.model.getEntities(2) if len(gmsh.model.getAdjacencies(2, tag)[0]) == 1]
    if not outer:
        sys.exit("it holds no solid: export a solid body, not surfaces or wires")
    box = gmsh.model.getBoundingBox(-1, -1)
    longest = max(box[k + 3] - box[k] for k in range(3))
    if not is_stl:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", ROUND)
    if "out" not in job:
        gmsh.option.setNumber("Mesh.MeshSizeMax", longest / _PICTURE_CELLS)
        if not is_stl:
            gmsh.model.mesh.generate(2)
        pieces = read_pieces(gmsh)
        surfaces = [
            {"number": tag, "kind": gmsh.model.getType(2, tag), "triangles": pieces[2, tag].ravel().tolist()}
            for tag in outer
        ]
        volumes = [tag for _, tag in gmsh.model.getEntities(3)]
        return {
            "surfaces": surfaces,
            "volume": None if is_stl else sum(gmsh.model.occ.getMass(3, tag) for tag in volumes),
        }
    gmsh.option.setNumber("Mesh.MeshSizeMax", job["size"])
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    for name, numbers in job["names"].items():
        gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, numbers), name)
    volumes = [tag for _, tag in gmsh.model.getEntities(3)]
    for k, volume in enumerate(volumes):
        name = "body" if len(volumes) == 1 else f"body_{k + 1}"
        gmsh.model.setPhysicalName(3, gmsh.model.addPhysicalGroup(3, [volume]), name)
    pieces = read_pieces(gmsh) if is_stl else {}
    gmsh.model.mesh.generate(3)
    if is_stl:
        curve_cells(gmsh, pieces, job["size"])
    else:
        _optimise(gmsh)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.ScalingFactor", job["scale"])
    gmsh.write(job["out"])
    return {}


def _optimise(gmsh: Any) -> None:
    """Unfold curved cells; where gmsh fails in that, reading the mesh says where they are."""
    try:
        gmsh.model.mesh.optimize("HighOrder")
    except Exception as error:  # gmsh raises no other
        print(error, file=sys.stderr)


def _open_cad(gmsh: Any, path: str, angle: float) -> None:
    """Import a file's solids; those that touch share their surfaces."""
    del angle
    occ = gmsh.model.occ
    solids = [part for part in occ.importShapes(path) if part[0] == 3]
    if len(solids) > 1:
        occ.fragment(solids[:1], solids[1:])
    occ.synchronize()


if __name__ == "__main__":
    try:
        print(json.dumps(_in_this_process(json.load(sys.stdin))))
    except Exception as error:  # gmsh raises no other
        sys.exit(str(error))
