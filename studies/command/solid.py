"""``bellowsx mesh`` of a solid (STEP, IGES, BREP, STL): its numbered surfaces and a picture of them, or a mesh file."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from meshes.by_gmsh.cad import Solid, mesh_solid
from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.errors import MeshError
from meshes.quality import region_volumes_mm3
from meshes.solid import SolidMesh
from meshes.users.surfaces import RIGID, SURFACES, is_rigid
from studies.command.common import check_writable, say
from studies.report.pictures.surfaces import draw_surfaces
from studies.report.tables import Table, as_text

# A mesh may miss this share of the solid's volume; more comes of cells too large for its curves.
VOLUME_SHARE = 0.01
# A surface whose mean normal is longer is flat.
FLAT = 0.99


def list_surfaces(solid: Solid) -> None:
    """Print a line per surface."""
    lines = [
        (
            str(s.number),
            s.kind.lower(),
            f"{s.area_mm2:.4g}",
            _vector(s.centre_mm),
            _vector(s.normal) if math.hypot(*s.normal) > FLAT else "curved",
        )
        for s in solid.surfaces
    ]
    say(as_text(Table(("surface", "kind", "area, mm²", "centre, mm", "normal"), tuple(lines), ())))
    say(f"volume: {solid.volume_mm3:.6g} mm³")


def draw(picture: Path, file: Path, solid: Solid, names: Mapping[str, tuple[int, ...]]) -> None:
    """Draw the surfaces with their numbers, and names as far as given."""
    check_writable(picture.parent)
    draw_surfaces(picture, file.name, solid.surfaces, {n: name for name, numbers in names.items() for n in numbers})
    say(f"picture: {picture}")


def _vector(values: Sequence[float]) -> str:
    return "(" + ", ".join(f"{0.0 if abs(x) < 5e-4 else x:.4g}" for x in values) + ")"


def parse_names(given: Sequence[str], solid: Solid) -> dict[str, tuple[int, ...]]:
    """Numbers of the surfaces of each name, from ``name=1,2``.

    Raises
    ------
    MeshError
        For names and numbers that are unknown, numbers with two names, or no cavity.
    """
    known = {s.number for s in solid.surfaces}
    names: dict[str, tuple[int, ...]] = {}
    for text in given:
        name, _, listed = text.partition("=")
        if not (name in SURFACES or is_rigid(name)) or name == "axis":
            allowed = ", ".join([*(n for n in SURFACES if n != "axis"), RIGID, f"{RIGID}_NAME"])
            raise MeshError(f"--name {text}: {name!r} is unknown; allowed: {allowed}")
        if not listed or not all(word.strip().isdigit() for word in listed.split(",")):
            raise MeshError(f"--name {text}: give numbers of surfaces, as in --name {name}=1,2")
        numbers = tuple(int(word) for word in listed.split(","))
        if absent := [n for n in numbers if n not in known]:
            raise MeshError(f"--name {text}: no surface {absent[0]}; there are {', '.join(map(str, sorted(known)))}")
        names[name] = names.get(name, ()) + numbers
    every = [n for numbers in names.values() for n in numbers]
    if twice := [n for n in every if every.count(n) > 1]:
        raise MeshError(f"--name: surface {twice[0]} is named more than once: give each one name, once")
    if "cavity" not in names:
        raise MeshError("--name: no surface is named 'cavity', where the pressure acts: give --name cavity=NUMBERS")
    return names


def write_mesh(
    file: Path,
    solid: Solid,
    out: Path,
    size_mm: float,
    names: dict[str, tuple[int, ...]],
    scale: float,
    angle_deg: float,
) -> SolidMesh:
    """Mesh a solid into a file that a scene takes; nothing is written unless a scene would take it.

    Raises
    ------
    MeshError
        If the file's name or the size is wrong, gmsh fails, or the mesh is not fit for use.
    """
    if out.suffix != ".msh":
        raise MeshError(f"--out {out}: a mesh of a solid is a gmsh file: give a name that ends in .msh")
    longest = max(
        float(s.triangles.reshape(-1, 3).max()) - float(s.triangles.reshape(-1, 3).min()) for s in solid.surfaces
    )
    if not 0.0 < size_mm <= longest:
        raise MeshError(f"--size {size_mm:g}: must be above 0 and at most the size of the solid, {longest:.4g} mm")
    check_writable(out.parent)
    with tempfile.TemporaryDirectory(dir=out.parent if out.parent.exists() else None) as folder:
        made = Path(folder) / out.name
        mesh_solid(file, made, size_mm, names, scale, angle_deg)
        mesh = read_user_mesh(made)
        share = sum(region_volumes_mm3(mesh).values()) / solid.volume_mm3 - 1.0
        if abs(share) > VOLUME_SHARE:
            raise MeshError(
                f"{file}: cells of {size_mm:g} mm miss its volume by {100.0 * share:+.2g} %: take a smaller --size"
            )
        out.parent.mkdir(parents=True, exist_ok=True)
        os.replace(made, out)
    say(f"mesh: {out}, {100.0 * share:+.2g} % off the solid's volume")
    return mesh
