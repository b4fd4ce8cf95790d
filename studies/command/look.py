"""``bellowsx check`` and ``mesh``: what is there, before anything is solved."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import click
from mpi4py import MPI

from meshes.solid import SolidMesh
from studies.command.common import FAULTS, MODEL, examples, load_scenes, refuse, say
from studies.planning.levels import Model
from studies.results import provenance

POSITIVE = click.FloatRange(min=0.0, min_open=True)


@click.command(epilog=examples("bellowsx check", "bellowsx check my.toml scenes/*.toml"))
@click.argument("scenes", nargs=-1, type=click.Path(path_type=Path))
def check(scenes: tuple[Path, ...]) -> None:
    """Check SCENES for all their faults without solving them; without SCENES, what this machine runs on.

    Exit codes: 0 all sound, 2 faults, each named with its remedy.
    """
    if not scenes:
        sys.argv = ["check"]
        runpy.run_path(str(provenance.ROOT / "packages" / "check.py"), run_name="__main__")
        return
    for scene, _ in load_scenes(scenes):
        say(f"{scene.name}: sound")


@click.command(
    epilog=examples(
        "bellowsx mesh scenes/heung-t2-ri5.toml --model full3d",
        "bellowsx mesh part.msh",
        "bellowsx mesh part.step",
        "bellowsx mesh part.step --size 0.5 --name cavity=4,5 --name clamped=3 --out part.msh",
    )
)
@click.argument("file", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@MODEL
@click.option("--level", type=click.IntRange(1, 8), default=1, show_default=True, help="Refinement of the meridian.")
@click.option("--around", type=click.IntRange(4), default=8, show_default=True, help="Cells round, in 3D.")
@click.option(
    "--scale", type=POSITIVE, default=1.0, show_default=True, help="Factor that makes the lengths of a file mm."
)
@click.option("--size", type=POSITIVE, help="Of a solid: largest edge of a cell, mm.")
@click.option("--name", "names", multiple=True, metavar="NAME=N,N", help="Of a solid: name surfaces by number; repeat.")
@click.option("--angle", type=POSITIVE, default=40.0, show_default=True, help="Of an STL: degrees that part surfaces.")
@click.option("--picture", type=click.Path(path_type=Path), help="Of a solid: PNG of its surfaces [FILE-surfaces.png].")
@click.option("--out", type=click.Path(path_type=Path), help="Write the mesh here: .vtu for ParaView, of a solid .msh.")
def mesh(
    file: Path,
    model: Model | None,
    level: int,
    around: int,
    scale: float,
    size: float | None,
    names: tuple[str, ...],
    angle: float,
    picture: Path | None,
    out: Path | None,
) -> None:
    """Print the size, quality and named surfaces of the mesh of FILE, a bellows' scene or a gmsh file.

    Of a solid (.step, .stp, .iges, .igs, .brep, .stl) make a mesh that a scene takes; without --name list its numbered
    surfaces and draw them.
    """
    from meshes.by_gmsh.cad import ENDINGS

    if MPI.COMM_WORLD.rank:
        return
    try:
        if file.suffix.lower() in ENDINGS:
            _mesh_of_solid(file, scale, size, names, angle, picture, out)
            return
        if size is not None or names or picture is not None:
            refuse(f"{file}: --size, --name and --picture are for solids ({', '.join(ENDINGS)})")
        found = _mesh_of(file, model, level, around, scale)
    except FAULTS as error:
        refuse(str(error))
    _describe(found)
    if out is not None:
        from solvers.vtu import save_mesh

        save_mesh(out, found)
        say(f"mesh: {out}")


def _mesh_of(file: Path, model: Model | None, level: int, around: int, scale: float) -> SolidMesh:
    """The mesh of a bellows' scene, or of a gmsh file."""
    from meshes.by_gmsh.user_mesh import read_user_mesh
    from studies.scene.bellows import BellowsScene, core_shift_mm
    from studies.scene.meshes import scene_body, scene_meridian

    if file.suffix != ".toml":
        return read_user_mesh(file, scale)
    ((scene, _),) = load_scenes((file,), model)
    if not isinstance(scene, BellowsScene):
        refuse(f"{file}: give a bellows' scene or a gmsh file; the mesh of a simple body is chosen by its plan")
    found = scene_meridian(scene, level)
    if model in ("sector", "full3d"):
        found = scene_body(found, model, around, core_shift_mm(scene))
    return found


def _mesh_of_solid(
    file: Path,
    scale: float,
    size: float | None,
    given: tuple[str, ...],
    angle: float,
    picture: Path | None,
    out: Path | None,
) -> None:
    """List and draw the surfaces of a solid, or mesh it."""
    from meshes.by_gmsh.cad import read_solid
    from studies.command.solid import draw, list_surfaces, parse_names, write_mesh

    wanted = [bool(given), size is not None, out is not None]
    if any(wanted) and not all(wanted):
        refuse(
            f"{file}: a mesh of a solid takes --name (cavity=NUMBERS at least), --size, the largest edge of a cell in "
            "mm, and --out, the .msh to write; with none of them its surfaces are listed"
        )
    solid = read_solid(file, scale, angle)
    if size is None or out is None:
        list_surfaces(solid)
        draw(picture or Path(f"{file.stem}-surfaces.png"), file, solid, {})
        example = f"bellowsx mesh {file} --size MM --name cavity=NUMBERS --name clamped=NUMBERS --out {file.stem}.msh"
        say(f"a mesh of it: {example}")
        return
    names = parse_names(given, solid)
    _describe(write_mesh(file, solid, out, size, names, scale, angle))
    if picture is not None:
        draw(picture, file, solid, names)
    say(f'in a scene: [geometry] kind = "mesh", file = "{out.name}"')


def _describe(found: SolidMesh) -> None:
    """Print size, quality and named surfaces of a mesh."""
    from meshes.quality import mesh_quality, region_volumes_mm3
    from meshes.solid import FACETS

    quality = mesh_quality(found)
    size = " x ".join(f"{length:.4g}" for length in found.points.max(axis=0) - found.points.min(axis=0))
    say(f"{quality.cells} {found.cell.name} cells of second order, {quality.nodes} nodes, box {size} mm")
    say(f"least over largest Jacobian in a cell: {quality.min_jacobian_ratio:.3f}")
    for region, volume in region_volumes_mm3(found).items():
        if volume:
            say(f"region {region}: {volume:.6g} mm³")
    for number, names in found.volumes:
        say(f"volume {' and '.join(names) or 'without a name'}: {int((found.regions == number).sum())} cells")
    for body, name in enumerate(found.rigid):
        say(f"surface {name}: {int((found.facet_bodies == body).sum())} facets, a rigid body")
    for name, number in FACETS.items():
        if found.rigid and name == "bond":
            continue
        if count := int((found.facet_tags == number).sum()):
            say(f"surface {name}: {count} facets")
