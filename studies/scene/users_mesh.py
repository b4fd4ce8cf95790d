"""What a scene asks of a user's mesh, against what the file names: supports, tip, rigid surfaces, materials."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.solid import FACETS, SolidMesh
from meshes.users.rigid import rim_on
from meshes.users.surfaces import open_rim
from studies.scene.body_geometry import MeshGeometry


def mesh_faults(
    g: MeshGeometry, tip: str, tip_force_n: float, quantities: Sequence[str], tables: Sequence[str]
) -> list[str]:
    """A line per fault.

    Parameters
    ----------
    g
        The mesh.
    tip, tip_force_n
        How its tip is held or loaded.
    quantities
        What is requested.
    tables
        Names of volumes with a material of their own.

    Raises
    ------
    MeshError
        If the file cannot be used.
    """
    mesh = read_user_mesh(Path(g.file), g.scale)
    faults = _tip_faults(g, mesh, tip, tip_force_n, quantities)
    if "volume_mm3" in quantities and (where := open_rim(mesh)):
        faults.append(f"ask.quantities = 'volume_mm3': {where}")
    if "reaction_n" in quantities and not has_surface(mesh.facet_tags, "clamped"):
        faults.append("ask.quantities = 'reaction_n': no surface of the mesh is named 'clamped'")
    for k, name in enumerate(mesh.rigid):
        if rim_on(mesh, mesh.facets[mesh.facet_bodies == k]).edges:
            faults.append(
                f"geometry.file: the cavity ends on {name!r}, which does not close it: name that surface 'tip' and set "
                'geometry.tip = "rigid"'
            )
    return faults + _free_motions(mesh, tip) + material_table_faults(mesh, tables)


def _tip_faults(g: MeshGeometry, mesh: SolidMesh, tip: str, tip_force_n: float, quantities: Sequence[str]) -> list[str]:
    given = {
        f"load.tip_force_n = {tip_force_n:g}": tip_force_n != 0.0,
        'load.tip = "blocked"': tip == "blocked",
        'geometry.tip = "rigid"': g.tip == "rigid",
        "ask.quantities = 'tip_mm'": "tip_mm" in quantities,
        "ask.quantities = 'tip_force_n'": "tip_force_n" in quantities,
    }
    if not has_surface(mesh.facet_tags, "tip"):
        return [f"{what}: no surface of the mesh is named 'tip'" for what, is_given in given.items() if is_given]
    faults = []
    force = f"load.tip_force_n = {tip_force_n:g}"
    if tip_force_n and tip == "blocked":
        faults.append(f'{force}: a blocked tip takes no force: it must be 0, or load.tip = "free"')
    if "tip_force_n" in quantities and tip == "free":
        faults.append('ask.quantities: "tip_force_n" of a free tip is what is given: set load.tip = "blocked"')
    if tip_force_n and g.tip == "elastic" and mesh.rigid:
        faults.append(
            f'{force}: beside the rigid surface {mesh.rigid[0]!r} it acts on a rigid tip: set geometry.tip = "rigid"'
        )
    if g.tip == "rigid" or tip_force_n:
        rim_on(mesh, mesh.facets[mesh.facet_tags == FACETS["tip"]])  # told if it is one that a plate cannot close
    return faults


def has_surface(tags: Any, name: str) -> bool:
    """True if a mesh's facets have a name."""
    return bool((tags == FACETS[name]).any())


def _free_motions(mesh: SolidMesh, tip: str) -> list[str]:
    """Directions in which nothing holds a user's mesh."""
    tags = mesh.facet_tags
    if has_surface(tags, "clamped"):
        return []
    along: dict[str, tuple[str, ...]] = {"z": ("symmetry_z", "bottom", "top")}
    if mesh.dimension == 3:
        along = {"x": ("symmetry_x",), "y": ("symmetry_y",), **along}
    free = [axis for axis, names in along.items() if not any(has_surface(tags, name) for name in names)]
    if tip == "blocked":
        free = [axis for axis in free if axis != "z"]
    if not free:
        return []
    needed = "; ".join(f"along {axis}: {' or '.join(along[axis])}" for axis in free)
    return [f"geometry.file: nothing holds the body: name a surface 'clamped', or planes that keep it ({needed})"]


def material_table_faults(mesh: SolidMesh, tables: Sequence[str]) -> list[str]:
    """Tables of materials that no volume has, or two that claim the same cells."""
    what = "volume" if mesh.dimension == 3 else "surface"
    known = list(dict.fromkeys(name for _, names in mesh.volumes for name in names))
    faults = []
    for name in tables:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}? " if near else ""
            named = ", ".join(known) or "none"
            faults.append(f"materials.{name}: no physical {what} of the mesh has this name; {hint}named are: {named}")
    for _, names in mesh.volumes:
        both = [name for name in names if name in tables]
        if len(both) > 1:
            faults.append(
                f"materials.{both[0]} and materials.{both[1]}: both physical {what}s hold the same cells: leave one of "
                "the tables out, or draw the groups apart"
            )
    return faults


def numbers_of_tables(mesh: SolidMesh, tables: Sequence[str]) -> dict[int, str]:
    """Region numbers of a mesh with a material of their own, and its table's name."""
    return {number: name for number, names in mesh.volumes for name in names if name in tables}
