"""Named surfaces of a user's mesh: physical surfaces of a body, physical curves of a meridian.

What a name asks for must be possible where it is put: planes of symmetry and planes that keep their height are planes,
and what lies on r = 0 is a meridian's axis by where it is, whatever its name.
"""

from __future__ import annotations

import difflib
from pathlib import Path

import numpy as np

from meshes.cells import FloatArray, IntArray
from meshes.errors import MeshError
from meshes.solid import FACETS, SolidMesh
from meshes.users.contents import Contents
from meshes.users.neighbours import Neighbours, rim

# What a physical surface (curve) may be called; bottom and top are planes that keep their height.
SURFACES = ("cavity", "clamped", "outer", "tip", "axis", "bottom", "top", "symmetry_x", "symmetry_y", "symmetry_z")
# A surface whose name begins so moves as a rigid body; until all is checked it has a number of its own from here on.
RIGID, FIRST_RIGID = "rigid", 101
# Planes, and the coordinate that is the same all over them; of a meridian 1 is z.
PLANES = {
    2: {"bottom": 1, "top": 1, "symmetry_z": 1},
    3: {"symmetry_x": 0, "symmetry_y": 1, "bottom": 2, "top": 2, "symmetry_z": 2},
}
# Names that may stand on r = 0: none of them asks for more than an axis has.
ON_AXIS = ("axis", "symmetry_x", "symmetry_y", "outer")
# A facet of a plane may be tilted by this much: a displacement would be off by its square.
TILT = 1e-3
# Nodes nearer to r = 0 than this part of the box are put on it.
SNAP = 1e-5
# An edge that goes along the axis within this part of the box, and is not on it, is a misplaced axis unless it is named
# as a surface of its own.
NEAR_AXIS = 1e-3


def named_facets(contents: Contents, used: IntArray, dimension: int) -> tuple[IntArray, IntArray, tuple[str, ...]]:
    """Corner nodes of the named facets, ascending, their surface numbers, and names of those that are rigid bodies.

    Parameters
    ----------
    contents
        What the file holds.
    used
        gmsh's numbers of the nodes of cells, ascending.
    dimension
        Of the cells.

    Raises
    ------
    MeshError
        If a name is unknown, missing, given to nothing, or to what belongs to no cell.
    """
    path, what = contents.path, "surface" if dimension == 3 else "curve"
    groups = [group for group in contents.groups if group.dimension == dimension - 1]
    facets, tags = [np.empty((0, 0), dtype=np.int64)][:0], [np.empty(0, dtype=np.int64)]
    rigid: list[str] = []
    for group in groups:
        if not group.name:
            raise MeshError(
                f"{path}: physical {what} {group.number} has no name: name it, for instance "
                f'Physical {what.title()}("cavity") = {{...}}; allowed: {", ".join(SURFACES)}'
            )
        if group.name not in SURFACES and not is_rigid(group.name):
            near = difflib.get_close_matches(group.name.lower(), (*SURFACES, RIGID), n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}? " if near else ""
            allowed = f"{', '.join(SURFACES)}, {RIGID} and {RIGID}_NAME (a rigid body each)"
            raise MeshError(f"{path}: physical {what} {group.name!r} is unknown; {hint}allowed: {allowed}")
        if is_rigid(group.name) and group.name not in rigid:
            rigid.append(group.name)
        number = FIRST_RIGID + rigid.index(group.name) if is_rigid(group.name) else FACETS[group.name]
        corners = _corners_of(contents, group.entities, dimension - 1)
        if not sum(map(len, corners)):
            raise MeshError(
                f"{path}: physical {what} {group.name!r} holds nothing: no {what} of the mesh is in it; put one in, or "
                "delete the group"
            )
        for part in corners:
            if not np.isin(part, used).all():
                raise MeshError(f"{path}: physical {what} {group.name!r} has nodes that belong to no cell")
            facets.append(np.sort(np.searchsorted(used, part), axis=1))
            tags.append(np.full(len(part), number))
    if all(group.name != "cavity" for group in groups):
        given = ", ".join(repr(group.name) for group in groups) or "none"
        elsewhere = [group for group in contents.groups if group.name == "cavity"]
        hint = "".join(f"; 'cavity' is a group of dimension {g.dimension}, not {dimension - 1}" for g in elsewhere)
        raise MeshError(
            f"{path}: no physical {what} is named 'cavity', where the pressure acts; named are: {given}{hint}"
        )
    return _stacked(path, facets), np.concatenate(tags), tuple(rigid)


def is_rigid(name: str) -> bool:
    """True if a surface of this name moves as a rigid body."""
    return name == RIGID or name.startswith(f"{RIGID}_")


def rigid_bodies(tags: IntArray) -> tuple[IntArray, IntArray]:
    """Surface numbers with rigid bodies as ``bond``, and the body of each facet, -1 for none."""
    of_rigid = tags >= FIRST_RIGID
    return np.where(of_rigid, FACETS["bond"], tags), np.where(of_rigid, tags - FIRST_RIGID, -1)


def _stacked(path: Path, facets: list[IntArray]) -> IntArray:
    """Facets of all names in one array; refused if triangles and quadrilaterals are among them."""
    if len({part.shape[1] for part in facets}) > 1:
        raise MeshError(
            f"{path}: named surfaces hold triangles and quadrilaterals, of which cells of one kind have one"
        )
    return np.vstack(facets)


def _corners_of(contents: Contents, entities: tuple[int, ...], dimension: int) -> list[IntArray]:
    """Corners of the elements of some entities, by kind, in gmsh's numbers."""
    return [
        part.nodes[np.isin(part.entities, entities)][:, : part.kind.corners]
        for part in contents.of_dimension(dimension)
        if np.isin(part.entities, entities).any()
    ]


def check_facets(path: Path, facets: IntArray, tags: IntArray, found: Neighbours) -> None:
    """Refuse named facets that are not on the boundary, or have two names."""
    unique, count = np.unique(facets, axis=0, return_counts=True)
    if (count > 1).any():
        twice = unique[np.argmax(count)]
        named = sorted(_name(n) for n in np.unique(tags[(facets == twice).all(axis=1)]))
        how = (
            f"is named {count.max()} times ({named[0]})"
            if len(named) == 1
            else f"has {len(named)} names ({', '.join(named)})"
        )
        raise MeshError(f"{path}: a facet {how}, and {int((count > 1).sum())} facets in all: give each one name, once")
    boundary = {tuple(f) for f in np.sort(found.corners(found.boundary), axis=1).tolist()}
    inside = [int(tag) for f, tag in zip(facets.tolist(), tags, strict=True) if tuple(f) not in boundary]
    if inside:
        raise MeshError(
            f"{path}: {len(inside)} facets named {_name(inside[0])!r} are not on the boundary of the cells: they lie "
            "between two cells, or on no cell's side"
        )


def _name(number: int) -> str:
    return next((name for name, n in FACETS.items() if n == number), RIGID)


def check_planes(path: Path, points: FloatArray, facets: IntArray, tags: IntArray) -> None:
    """Refuse planes of symmetry and of constant height that are none, and names that the dimension has no use for."""
    dimension = points.shape[1]
    axes, planes = "rz" if dimension == 2 else "xyz", PLANES[dimension]
    for number in np.unique(tags):
        name, at = _name(int(number)), points[facets[tags == number]]
        if name in planes:
            i = planes[name]
            size = np.linalg.norm(at - np.roll(at, 1, axis=1), axis=2).max(axis=1)
            tilt = np.ptp(at[:, :, i], axis=1) / size
            if tilt.max() > TILT:
                worst = ", ".join(f"{x:.4g}" for x in at[int(np.argmax(tilt))].mean(axis=0))
                raise MeshError(
                    f"{path}: {name!r} keeps {axes[i]} on planes {axes[i]} = const, and is tilted by {tilt.max():.3g} "
                    f"near ({worst}) mm: name planes only, or turn the body"
                )
        elif dimension == 3 and name == "axis":
            raise MeshError(f"{path}: 'axis' is a meridian's line r = 0; a body has none: delete the physical surface")


def cavity_rim(mesh: SolidMesh) -> IntArray:
    """Corners of the edges at which a body's cavity ends, shape (r, 2); of a meridian's the nodes, shape (r, 1)."""
    found = Neighbours(mesh.cells, mesh.cell)
    corners = found.corners(found.boundary)
    cavity = mesh.facets[mesh.facet_tags == FACETS["cavity"]]
    base = len(mesh.points)
    return rim(corners[np.isin(_three(np.sort(corners, axis=1), base), _three(cavity, base))])


def open_rim(mesh: SolidMesh) -> str:
    """Where the rim of a body's cavity is not in a plane from which enclosed volumes are counted; empty if it is.

    A cavity is closed by planes z = const, and by planes of symmetry only at x = 0 and y = 0: those elsewhere would add
    a volume of their own (`solvers.energy.loads`).
    """
    if mesh.dimension == 2:
        return ""
    edges = cavity_rim(mesh)
    size = float(np.ptp(mesh.points, axis=0).max())
    at = mesh.points[edges]
    closed = (np.abs(at[:, :, :2]) <= SNAP * size).all(axis=1).any(axis=1)
    along = np.diff(at, axis=1)[:, 0]
    loose = at[~closed & (np.abs(along[:, 2]) > TILT * np.linalg.norm(along, axis=1))]
    if not len(loose):
        return ""
    where = ", ".join(f"{x:.4g}" for x in loose[0].mean(axis=0))
    return (
        f"the cavity ends near ({where}) mm, not at z = const, x = 0 or y = 0, where volumes are counted from: "
        "move or turn the body so that it does, or ask for other quantities"
    )


def _three(facets: IntArray, base: int) -> IntArray:
    """A number per facet of ascending corners: three of them tell one from another, of a meridian's two."""
    return (facets[:, 0] * base + facets[:, 1]) * base + facets[:, min(2, facets.shape[1] - 1)]


# --- the axis of a meridian -------------------------------------------------------------------------------------


def on_the_axis(path: Path, points: FloatArray) -> FloatArray:
    """Columns (r, z) of a plane mesh, nodes as good as on the axis exactly there.

    Raises
    ------
    MeshError
        If it crosses r = 0.
    """
    size = float(np.ptp(points, axis=0).max())
    flat = points[:, :2].copy()
    if flat[:, 0].min() < -SNAP * size:
        raise MeshError(
            f"{path}: a meridian has r = x >= 0; this one reaches x = {flat[:, 0].min():g}: draw one half only, and "
            f"move its axis to x = 0 (nodes within {SNAP * size:.3g} of it are put there)"
        )
    flat[np.abs(flat[:, 0]) <= SNAP * size, 0] = 0.0
    return np.asarray(flat)


def with_axis(
    path: Path, points: FloatArray, facets: IntArray, tags: IntArray, found: Neighbours
) -> tuple[IntArray, IntArray]:
    """The facets of a meridian, all boundary edges on r = 0 as ``axis``, whatever they were called.

    Raises
    ------
    MeshError
        If an edge there has a name that an axis cannot have, the name ``axis`` (or that of a plane through it) is
        elsewhere, an edge runs beside r = 0 too near to be meant, or the body touches r = 0 in a point.
    """
    rows = found.boundary
    edges = np.sort(found.corners(rows), axis=1)
    middle = found.cells[found.owner[rows], found.cell.corners + found.which[rows]]
    size = float(np.ptp(points, axis=0).max())
    radius = points[:, 0]
    on = (radius[edges] == 0.0).all(axis=1) & (radius[middle] == 0.0)
    name_of = {tuple(f): _name(int(n)) for f, n in zip(facets.tolist(), tags, strict=True)}
    names = np.array([name_of.get(tuple(e), "") for e in edges.tolist()])
    wrong = on & (names != "") & ~np.isin(names, ON_AXIS)
    if wrong.any():
        raise MeshError(
            f"{path}: {int(wrong.sum())} edges named {str(names[wrong][0])!r} lie on r = 0, which is the axis, inside "
            "the body: leave them without a name or call them 'axis'"
        )
    _check_beside_axis(path, points, edges[~on], names[~on], size)
    alone = np.setdiff1d(edges[(radius[edges] == 0.0).any(axis=1)][:, :], edges[on])
    alone = alone[radius[alone] == 0.0]
    if len(alone):
        raise MeshError(
            f"{path}: the body touches r = 0 in a point, near z = {points[alone[0], 1]:.4g} mm, and has no edge there: "
            "open a bore, or let it reach the axis along an edge"
        )
    kept = ~np.isin(_keys(facets, len(points)), _keys(edges[on], len(points)))
    axis = np.full(int(on.sum()), FACETS["axis"])
    return np.vstack([facets[kept], edges[on]]), np.concatenate([tags[kept], axis])


def _keys(edges: IntArray, base: int) -> IntArray:
    return edges[:, 0] * base + edges[:, 1]


def _check_beside_axis(path: Path, points: FloatArray, edges: IntArray, names: np.ndarray, size: float) -> None:
    """Refuse edges off r = 0 that are called its axis, or run beside it too near to be meant."""
    ends = points[edges]
    radius = ends[:, :, 0].max(axis=1)
    along = np.abs(np.diff(ends[:, :, 0], axis=1)).ravel() < 0.1 * np.abs(np.diff(ends[:, :, 1], axis=1)).ravel()
    called = np.isin(names, ("axis", "symmetry_x", "symmetry_y"))
    misplaced = called | ((names == "") & along & (radius < NEAR_AXIS * size))
    if misplaced.any():
        worst = int(np.argmax(np.where(misplaced, radius, -1.0)))
        called_what = f"named {str(names[worst])!r}" if names[worst] else "without a name"
        raise MeshError(
            f"{path}: an edge {called_what} reaches r = {radius[worst]:.4g} mm, beside the axis r = 0: move the axis "
            f"to x = 0 (nodes within {SNAP * size:.3g} mm are put there), or name a bore of its own 'outer'"
        )
