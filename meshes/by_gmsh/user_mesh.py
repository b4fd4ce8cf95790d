"""A user's mesh: a gmsh file of second order with named surfaces, a body or a meridian, read and checked.

gmsh reads it in a child process, for it can abort the process on a bad file. In 3D the cells are ten-node tetrahedra
and physical surfaces carry the names; a meridian lies in gmsh's x-y plane with x = r and y = z, its cells are six-node
triangles and physical curves carry the names. Names are those of ``SURFACES``.
"""

from __future__ import annotations

import difflib
import json
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from meshes.by_gmsh.child import run_gmsh
from meshes.errors import MeshError
from meshes.quality import jacobians
from meshes.solid import FACETS, REGIONS, FloatArray, IntArray, SolidMesh

# What a physical surface (curve) may be called; bottom and top are planes that keep their height.
SURFACES = ("cavity", "clamped", "outer", "tip", "axis", "bottom", "top", "symmetry_x", "symmetry_y", "symmetry_z")
# Longest edge of the bounding box, mm: a 50 mm actuator in metres is below, one in micrometres above.
SMALLEST_MM, LARGEST_MM = 0.5, 2000.0
# A cell is flat if its least Jacobian is below this part of its longest edge to the power of the dimension: a hundredth
# of what a sliver has that a solver would still take.
FLAT = 1e-6
# Nodes this close to r = 0, as a part of the box, are on the axis.
ON_AXIS = 1e-9

# gmsh's element types: name, dimension, and its nodes in basix order where this program takes them.
_TYPES: dict[int, tuple[str, int, list[int] | None]] = {
    2: ("3-node triangles", 2, None),
    3: ("4-node quadrilaterals", 2, None),
    4: ("4-node tetrahedra", 3, None),
    5: ("8-node hexahedra", 3, None),
    6: ("6-node prisms", 3, None),
    7: ("5-node pyramids", 3, None),
    9: ("6-node triangles", 2, [0, 1, 2, 4, 5, 3]),
    10: ("9-node quadrilaterals", 2, None),
    11: ("10-node tetrahedra", 3, [0, 1, 2, 3, 8, 9, 5, 7, 6, 4]),
    12: ("27-node hexahedra", 3, None),
}
_FIRST_ORDER = (2, 3, 4, 5, 6, 7)


def read_user_mesh(path: Path, scale: float = 1.0) -> SolidMesh:
    """Read a mesh.

    Parameters
    ----------
    path
        A file gmsh can open as a mesh, usually .msh.
    scale
        Factor that makes its lengths mm: 1000 for a mesh in metres.

    Returns
    -------
    SolidMesh
        All of it is elastomer. Edges of a meridian on r = 0 are ``axis`` without being named.

    Raises
    ------
    MeshError
        If it cannot be read, has cells of another kind, unknown or missing names, flipped or flat cells (with gmsh's
        number of the cell), or a size that is not one of mm.
    """
    try:
        stamp = path.stat().st_mtime_ns
    except OSError as error:
        raise MeshError(f"{path}: cannot be read ({error.strerror}); give the path of a gmsh file") from None
    return _checked(path.resolve(), scale, stamp)


@lru_cache(maxsize=4)
def _checked(path: Path, scale: float, stamp: int) -> SolidMesh:
    """As `read_user_mesh`; a scene's mesh is asked for several times, and ``stamp`` tells when the file changed."""
    head, arrays = _by_child(path)
    kind = _cell_type(path, head["types"])
    _, dimension, order = _TYPES[kind]
    raw, numbers = arrays[f"cells{kind}"], arrays[f"numbers{kind}"]
    used, back = np.unique(raw, return_inverse=True)
    place = np.searchsorted(arrays["tags"], used)
    points = scale * arrays["points"][place]
    cells = back.reshape(raw.shape).astype(np.int64)[:, order]
    if dimension == 2:
        points = _meridian_points(path, points)
    _check_size(path, points, scale)
    cells = _oriented(path, points, cells, numbers)
    facets, tags = _named_facets(path, head["names"], arrays, used, dimension)
    if dimension == 2:
        facets, tags = _add_axis(points, cells, facets, tags)
    _check_facets(path, cells, facets, tags, dimension)
    return SolidMesh(
        points=points,
        cells=cells,
        regions=np.full(len(cells), REGIONS["elastomer"]),
        facets=facets,
        facet_tags=tags,
        facet_bodies=np.full(len(facets), -1),
        tip_centre_node=int(np.lexsort((points[:, 0], -points[:, -1]))[0]),
    )


# --- reading ------------------------------------------------------------------------------------------------


def _by_child(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Names and arrays that a child process reads with gmsh."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "mesh.npz"
        run_gmsh("meshes.by_gmsh.user_mesh", f"{path}: gmsh cannot read it", str(path), str(answer))
        if not answer.exists():
            raise MeshError(f"{path}: gmsh cannot read it")
        with np.load(answer, allow_pickle=False) as data:
            arrays = dict(data)
    return json.loads(str(arrays.pop("head"))), arrays


def _read_in_this_process(path: str, answer: str) -> None:
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    arrays: dict[str, Any] = {
        "tags": np.asarray(tags, dtype=np.int64)[order],
        "points": np.asarray(coordinates).reshape(-1, 3)[order],
    }
    types = [int(kind) for kind in gmsh.model.mesh.getElementTypes() if int(kind) in _TYPES]
    for kind in types:
        numbers, nodes = gmsh.model.mesh.getElementsByType(kind)
        arrays[f"numbers{kind}"] = np.asarray(numbers, dtype=np.int64)
        arrays[f"cells{kind}"] = np.asarray(nodes, dtype=np.int64).reshape(len(numbers), -1)
    names = []
    for dimension in (1, 2):
        for dim, group in gmsh.model.getPhysicalGroups(dimension):
            parts = []
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, group):
                found, numbers, nodes = gmsh.model.mesh.getElements(dim, entity)
                for one, its, at in zip(found, numbers, nodes, strict=True):
                    corners = {1: 2, 8: 2, 2: 3, 9: 3}.get(int(one))
                    if corners is not None:
                        parts.append(np.asarray(at, dtype=np.int64).reshape(len(its), -1)[:, :corners])
            names.append([dim, gmsh.model.getPhysicalName(dim, group)])
            arrays[f"facets{len(names) - 1}"] = np.vstack(parts) if parts else np.empty((0, dim + 1), dtype=np.int64)
    gmsh.finalize()
    np.savez(answer, head=json.dumps({"types": types, "names": names}), **arrays)


def _cell_type(path: Path, types: list[int]) -> int:
    """The one kind of cells of a mesh: those of the highest dimension."""
    if not types:
        raise MeshError(f"{path}: holds no cells; mesh it before saving, and save all elements or name the volumes")
    highest = max(_TYPES[kind][1] for kind in types)
    kinds = [kind for kind in types if _TYPES[kind][1] == highest]
    shown = " and ".join(_TYPES[kind][0] for kind in kinds)
    if any(kind in _FIRST_ORDER for kind in kinds):
        raise MeshError(
            f"{path}: has {shown}: first order has straight edges and locks; mesh it with second order "
            "(gmsh -order 2, or Mesh.ElementOrder = 2)"
        )
    if len(kinds) > 1 or _TYPES[kinds[0]][2] is None:
        raise MeshError(f"{path}: has {shown}: take 10-node tetrahedra, or 6-node triangles for a meridian")
    return kinds[0]


# --- checks -------------------------------------------------------------------------------------------------


def _meridian_points(path: Path, points: FloatArray) -> FloatArray:
    """Columns (r, z) of a plane mesh, nodes on the axis exactly there."""
    size = float(np.ptp(points, axis=0).max())
    if np.abs(points[:, 2]).max() > ON_AXIS * size:
        raise MeshError(f"{path}: a meridian lies in gmsh's plane z = 0, with x = r and y = z; this one leaves it")
    if points[:, 0].min() < -ON_AXIS * size:
        raise MeshError(f"{path}: a meridian has r = x >= 0; this one reaches x = {points[:, 0].min():g}")
    flat = points[:, :2].copy()
    flat[np.abs(flat[:, 0]) <= ON_AXIS * size, 0] = 0.0
    return np.asarray(flat)


def _check_size(path: Path, points: FloatArray, scale: float) -> None:
    size = float(np.ptp(points, axis=0).max())
    if not SMALLEST_MM <= size <= LARGEST_MM:
        likely = "metres: set scale = 1000" if size < SMALLEST_MM else "micrometres: set scale = 0.001"
        raise MeshError(
            f"{path}: its bounding box is {size:g} mm long with scale = {scale:g}, outside {SMALLEST_MM:g} to "
            f"{LARGEST_MM:g} mm; if it was drawn in {likely}"
        )


def _oriented(path: Path, points: FloatArray, cells: IntArray, numbers: IntArray) -> IntArray:
    """The cells, all turned over if most are flipped (a surface drawn clockwise); what then is flipped is a fault."""
    signed = jacobians(points, cells)
    if (signed.mean(axis=1) < 0.0).mean() > 0.5:
        swapped = [0, 2, 1, 3, 5, 4] if points.shape[1] == 2 else [0, 2, 1, 3, 5, 4, 6, 7, 9, 8]
        cells, signed = cells[:, swapped], -signed
    corners = points[cells[:, : points.shape[1] + 1]]
    edges = corners[:, :, None] - corners[:, None]
    longest = np.linalg.norm(edges, axis=-1).max(axis=(1, 2))
    worst = int(np.argmin(signed.min(axis=1) / longest ** points.shape[1]))
    least, most = signed[worst].min(), signed[worst].max()
    where = ", ".join(f"{x:.4g}" for x in points[cells[worst]].mean(axis=0))
    at = f"{path}: cell {numbers[worst]} near ({where}) mm"
    if most <= 0.0 and least < -FLAT * longest[worst] ** points.shape[1]:
        raise MeshError(f"{at} is flipped: its nodes are numbered the other way than its neighbours'; mesh it anew")
    if least <= FLAT * longest[worst] ** points.shape[1]:
        how = "is flat" if most <= FLAT * longest[worst] ** points.shape[1] else "is folded over or has a flat corner"
        raise MeshError(f"{at} {how}: optimise the mesh (gmsh -optimize_ho) or refine it there")
    return cells


def _named_facets(
    path: Path, names: list[list[Any]], arrays: dict[str, Any], used: IntArray, dimension: int
) -> tuple[IntArray, IntArray]:
    """Corner nodes of the named facets, ascending, and their surface numbers."""
    what = "surface" if dimension == 3 else "curve"
    facets, tags = [np.empty((0, dimension), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    for k, (dim, name) in enumerate(names):
        if dim != dimension - 1:
            continue
        if name not in SURFACES:
            near = difflib.get_close_matches(name, SURFACES, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}? " if near else ""
            raise MeshError(f"{path}: physical {what} {name!r} is unknown; {hint}allowed: {', '.join(SURFACES)}")
        corners = arrays[f"facets{k}"]
        if not np.isin(corners, used).all():
            raise MeshError(f"{path}: physical {what} {name!r} has nodes that belong to no cell")
        facets.append(np.sort(np.searchsorted(used, corners), axis=1))
        tags.append(np.full(len(corners), FACETS[name]))
    every, numbers = np.vstack(facets), np.concatenate(tags)
    if FACETS["cavity"] not in numbers:
        given = ", ".join(repr(name) for dim, name in names if dim == dimension - 1) or "none"
        raise MeshError(f"{path}: no physical {what} is named 'cavity', where the pressure acts; named are: {given}")
    return every, numbers


def _add_axis(points: FloatArray, cells: IntArray, facets: IntArray, tags: IntArray) -> tuple[IntArray, IntArray]:
    """The facets of a meridian, edges on r = 0 that have no name added as ``axis``."""
    on_axis = points[:, 0] == 0.0
    edges = np.unique(np.sort(np.vstack([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [0, 2]]]), axis=1), axis=0)
    edges = edges[on_axis[edges].all(axis=1)]
    known = {tuple(f) for f in facets.tolist()}
    new = np.array([e for e in edges.tolist() if tuple(e) not in known], dtype=np.int64).reshape(-1, 2)
    return np.vstack([facets, new]), np.concatenate([tags, np.full(len(new), FACETS["axis"])])


def _check_facets(path: Path, cells: IntArray, facets: IntArray, tags: IntArray, dimension: int) -> None:
    """Named facets lie on the boundary and have one name each."""
    unique, count = np.unique(facets, axis=0, return_counts=True)
    if (count > 1).any():
        twice = unique[np.argmax(count)]
        named = sorted(name for name, n in FACETS.items() if n in tags[(facets == twice).all(axis=1)])
        raise MeshError(f"{path}: a facet has {count.max()} names ({', '.join(named)}): give it one")
    sides = [np.delete(np.arange(dimension + 1), k) for k in range(dimension + 1)]
    every = np.sort(np.vstack([cells[:, side] for side in sides]), axis=1)
    of_cells, shared = np.unique(every, axis=0, return_counts=True)
    boundary = {tuple(f) for f in of_cells[shared == 1].tolist()}
    inside = [int(tag) for f, tag in zip(facets.tolist(), tags, strict=True) if tuple(f) not in boundary]
    if inside:
        name = next(key for key, number in FACETS.items() if number == inside[0])
        raise MeshError(f"{path}: {len(inside)} facets named {name!r} are not on the boundary of the cells")


if __name__ == "__main__":
    _read_in_this_process(sys.argv[1], sys.argv[2])
