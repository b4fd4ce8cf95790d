"""``bellowsx report``: the report of a folder of results, anew."""

from __future__ import annotations

from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import examples, refuse

TITLE = "Silicone bellows actuator: closed form beside axisymmetric beside full 3D"
INTRODUCTION = (
    "Tip elongation of bellows actuators after Heung et al. 2024 (Biomimetics 9, 160, doi "
    "10.3390/biomimetics9030160) under cavity pressure, by the paper's closed-form model and by finite elements."
)


@click.command(epilog=examples("bellowsx report results/batch", "bellowsx report results/paper"))
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Write the report of a study's, batch's or scene's FOLDER anew from the results in it."""
    from studies.engine import load_study, render

    if MPI.COMM_WORLD.rank == 0:
        if (folder / "core").is_dir():
            render(load_study("paper"), folder)
            return
        for page in write_reports(folder):
            click.echo(f"report: {page}")


def write_reports(folder: Path) -> list[Path]:
    """Pages of a folder: of bellows, and beside them of bodies with exact answers."""
    from studies.models.session import SCENE_FILE
    from studies.report.scene_page import render_scenes
    from studies.scene.bodies import BodyScene
    from studies.scene.files import kept_scene
    from studies.verification.exact import render_exact

    folders = sorted(p.parent for p in folder.glob(f"*/{SCENE_FILE}"))
    folders = folders or ([folder] if (folder / SCENE_FILE).exists() else [])
    if not folders:
        refuse(f"{folder}: holds no scene results; run solve, batch or a study first")
    exact = [p for p in folders if isinstance(kept_scene(p / SCENE_FILE), BodyScene)]
    bellows = [p for p in folders if p not in exact]
    pages = [render_scenes(folder, TITLE, INTRODUCTION, bellows)] if bellows else []
    if exact:
        place = folder / "exact" if bellows else folder
        place.mkdir(exist_ok=True)
        pages.append(render_exact(place, exact))
    return pages
