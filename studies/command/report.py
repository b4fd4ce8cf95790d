"""``bellowsx report``: the report of a folder of results, anew."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
from mpi4py import MPI

from studies.command.common import examples, guarded, refuse

TITLE = "Silicone bellows actuators: closed form beside axisymmetric beside full 3D"
QUESTION = "What do the models say of these bellows, and how far are they apart?"


@click.command(epilog=examples("bellowsx report results/batch", "bellowsx report results/paper"))
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Write the report of a study's, batch's or scene's FOLDER anew from the results in it."""
    if MPI.COMM_WORLD.rank == 0:

        def work() -> int:
            write_reports(folder)
            return 0

        sys.exit(guarded(str(folder), work))


def write_reports(folder: Path) -> None:
    """Pages of a folder: of the paper study, of bellows, and beside them of bodies with exact answers."""
    from studies.catalogue import load_study
    from studies.engine import Solved, render
    from studies.models.session import SCENE_FILE
    from studies.report.scene_page import report_of
    from studies.report.scene_report import SceneReport
    from studies.scene.bodies import BodyScene
    from studies.scene.load import kept_scene
    from studies.smoke import study as smoke
    from studies.verification import exact

    if (folder / "core").is_dir():
        render(load_study("paper"), folder)
        return
    folders = sorted(p.parent for p in folder.glob(f"*/{SCENE_FILE}"))
    folders = folders or ([folder] if (folder / SCENE_FILE).exists() else [])
    if not folders:
        refuse(f"{folder}: holds no scene results; run solve, batch or a study first")
    solved: list[Solved[Any, SceneReport]] = [
        Solved(kept_scene(place / SCENE_FILE), report_of(place)) for place in folders
    ]
    bellows = [done for done in solved if not isinstance(done.case, BodyScene)]
    bodies = [done for done in solved if isinstance(done.case, BodyScene)]
    if bellows:
        render(replace(smoke.STUDY, title=TITLE, question=QUESTION), folder, bellows)
    if bodies:
        render(exact.STUDY, folder / "exact" if bellows else folder, bodies)
