"""``bellowsx check``, ``material`` and ``mesh``: what is there, before anything is solved."""

from __future__ import annotations

import json
import runpy
import sys
from pathlib import Path
from typing import Any

import click

from studies.command.common import FAULTS, JSON, MODEL, SCENE, examples, load_scenes, refuse, say
from studies.planning.levels import Model
from studies.report.tables import Table, as_text
from studies.results import provenance

# Stretches of the printed stress curves.
STRETCHES = (1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0)


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


@click.command(epilog=examples("bellowsx material scenes/heung-t2-ri5.toml", "bellowsx material my.toml --json"))
@SCENE
@JSON
def material(scene: Path, as_json: bool) -> None:
    """Print the law of SCENE: constants, initial moduli, and stresses in three homogeneous tests."""
    import numpy as np

    from analytical.exact.homogeneous import MODES, stress_curves
    from studies.planning.warnings import law_range
    from studies.scene.materials import describe_material, law_of

    ((checked, _),) = load_scenes((scene,))
    law = law_of(checked.material)
    curves = stress_curves(law, np.array(STRETCHES))
    modulus = 1e3 * law.initial_shear_modulus_mpa
    stresses = {mode: 1e3 * curves.nominal_mpa[mode] for mode in MODES}
    if as_json:
        content: dict[str, Any] = {
            "law": checked.material.model_dump(mode="json"),
            "initial_shear_modulus_kpa": modulus,
            "initial_youngs_modulus_kpa": 3.0 * modulus,
            "stretch": list(STRETCHES),
            "nominal_stress_kpa": {mode: values.tolist() for mode, values in stresses.items()},
        }
        say(json.dumps(content, indent=1))
        return
    say("\n".join(line for line in (describe_material(checked.material), law_range(checked.material)) if line))
    say(f"initial shear modulus {modulus:.4g} kPa, initial Young's modulus {3.0 * modulus:.4g} kPa")
    lines = [(f"{stretch:g}", *(f"{stresses[mode][k]:.4g}" for mode in MODES)) for k, stretch in enumerate(STRETCHES)]
    say(as_text(Table(("stretch", *(f"{mode}, nominal kPa" for mode in MODES)), tuple(lines), ())))


@click.command(epilog=examples("bellowsx mesh scenes/heung-t2-ri5.toml --model full3d", "bellowsx mesh part.msh"))
@click.argument("file", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@MODEL
@click.option("--level", type=click.IntRange(1, 8), default=1, show_default=True, help="Refinement of the meridian.")
@click.option("--around", type=click.IntRange(4), default=8, show_default=True, help="Cells round, in 3D.")
@click.option("--scale", default=1.0, show_default=True, help="Factor that makes the lengths of a gmsh file mm.")
@click.option("--out", type=click.Path(path_type=Path), help="Write it here for ParaView (.vtu).")
def mesh(file: Path, model: Model | None, level: int, around: int, scale: float, out: Path | None) -> None:
    """Print the size, quality and named surfaces of the mesh of FILE, a bellows' scene or a gmsh file."""
    from meshes.by_gmsh.user_mesh import read_user_mesh
    from meshes.quality import mesh_quality, region_volumes_mm3
    from meshes.solid import FACETS
    from studies.scene.bellows import BellowsScene, core_shift_mm
    from studies.scene.meshes import scene_body, scene_meridian

    try:
        if file.suffix == ".toml":
            ((scene, _),) = load_scenes((file,), model)
            if not isinstance(scene, BellowsScene):
                refuse(f"{file}: give a bellows' scene or a gmsh file; the mesh of a simple body is chosen by its plan")
            found = scene_meridian(scene, level)
            if model in ("sector", "full3d"):
                found = scene_body(found, model, around, core_shift_mm(scene))
        else:
            found = read_user_mesh(file, scale)
    except FAULTS as error:
        refuse(str(error))
    quality = mesh_quality(found)
    size = " x ".join(f"{length:.4g}" for length in found.points.max(axis=0) - found.points.min(axis=0))
    say(f"{quality.cells} {found.cell.name} cells of second order, {quality.nodes} nodes, box {size} mm")
    say(f"least over largest Jacobian in a cell: {quality.min_jacobian_ratio:.3f}")
    for region, volume in region_volumes_mm3(found).items():
        if volume:
            say(f"region {region}: {volume:.6g} mm³")
    for name, number in FACETS.items():
        if count := int((found.facet_tags == number).sum()):
            say(f"surface {name}: {count} facets")
    if out is not None:
        from solvers.vtu import save_mesh

        save_mesh(out, found)
        say(f"mesh: {out}")
