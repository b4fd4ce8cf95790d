"""The modes study: in which harmonics axisymmetric states are unstable, from which pressure on, in which shapes."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click

from studies.engine import Page, Setting, Solved, Study
from studies.models.modes import COUNTED_LEVELS, read_crossings
from studies.models.modes_model import ModesModel
from studies.modes.full3d import BAND, confirm_rows
from studies.modes.pictures import draw_mode
from studies.modes.results import SceneModes, count_rows, crossing_rows
from studies.modes.ring import RINGS, Ring, ring_rows
from studies.modes.tables import bodies_table, caption, counts_table, crossings_table, rings_table, summary
from studies.report.labels import level_label
from studies.results import provenance
from studies.results.rows import Row
from studies.scene.load import load_scene

SCENES: Final = provenance.ROOT / "scenes"
# The paper's four actuators, two of them with their tips held, a shorter one, and a clamped tube.
FILES: Final = (
    *(SCENES / f"heung-{name}.toml" for name in ("t1-ri5", "t1-ri7", "t2-ri5", "t2-ri7")),
    SCENES / "blocked-t2-ri5.toml",
    *(SCENES / "modes" / f"{name}.toml" for name in ("blocked-t1-ri5", "blocked-short", "tube-clamped")),
    *sorted((SCENES / "modes").glob("vacuum-*.toml")),  # to where their folds touch
)
# Of these the first crossing is confirmed on the whole body in 3D.
CONFIRMED: Final = ("blocked-short", "tube-clamped")


@dataclass(frozen=True)
class Case:
    """A scene, its file, and whether its first crossing is confirmed on the whole body in 3D."""

    model: ModesModel
    file: Path
    confirmed: bool

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.model.scene.name


def cases(options: Mapping[str, Any]) -> list[Case | Ring]:
    """The scenes that are given; else those of the study, and rings."""
    models = {file: ModesModel(load_scene(file)) for file in options["scenes"] or FILES}
    for model in models.values():
        model.check()
    if options["scenes"]:
        return [Case(model, file, options["full3d"]) for file, model in models.items()]
    return [*(Case(model, file, model.scene.name in CONFIRMED) for file, model in models.items()), *RINGS]


def solve(case: Case | Ring, at: Setting) -> SceneModes | list[Row]:
    """A scene on the counted meridians, on this rank alone, into a folder of its name; or rows of a ring."""
    if isinstance(case, Ring):
        return ring_rows(case)
    model, folder = case.model, at.out / case.name
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(case.file, folder / "scene.toml")
    places = [folder / f"axisymmetric-r{level}" for level in COUNTED_LEVELS]
    runs = [model.run(level, place, at.progress) for level, place in zip(COUNTED_LEVELS, places, strict=True)]
    counted = [any(row.unstable_by_m for row in run.path) for run in runs]
    crossings = [read_crossings(place) if known else [] for place, known in zip(places, counted, strict=True)]
    rows = [*count_rows(model, runs), *crossing_rows(model, runs, crossings)]
    if case.confirmed and crossings[0]:
        rows += confirm_rows(model, places[0], crossings[0][0])
    pictures = []
    for crossing in crossings[-1]:
        name = f"pictures/{case.name}-m{crossing.waves}.png"
        if fault := draw_mode(at.out / name, model, COUNTED_LEVELS[-1], places[-1], crossing):
            at.progress.warn(f"{case.name}: no picture of m = {crossing.waves}: {fault}")
        else:
            pictures.append((crossing, name))
    return SceneModes(model, runs, crossings, rows, pictures)


def page(solved: Sequence[Solved[Case | Ring, SceneModes | list[Row]]], at: Setting) -> Page:
    """What is stable and what is not, crossings, counts, whole bodies, rings, and pictures of the modes."""
    results = [done.result for done in solved if isinstance(done.result, SceneModes)]
    rows = [r for done in solved for r in (done.result.rows if isinstance(done.result, SceneModes) else done.result)]
    bodies, rings = [r for r in rows if r.model == "full3d"], [r for r in rows if r.scene.startswith("ring-")]
    said = summary(results, bodies, rings)
    content = {
        "summary": said,
        "crossings": crossings_table(results),
        "counts": counts_table(rows),
        "finest": level_label(f"r{COUNTED_LEVELS[-1]}"),
        "bodies": bodies_table(bodies),
        "band": f"{100.0 * BAND:g}",
        "rings": rings_table(rings),
        "pictures": [(file, caption(result.name, c)) for result in results for c, file in result.pictures],
    }
    crossings = [r for r in rows if r.quantity.startswith("crossing")]
    stopped = [stop for result in results for stop in result.stops]
    return Page(rows, content, stopped, tables={"crossings.csv": crossings}, headlines=said)


STUDY: Final = Study(
    name="modes",
    title="Modes that break the symmetry: from which pressure on, and in which shape",
    question="From which pressure on, and in which shape, do bodies of revolution leave their symmetry?",
    template="modes/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    options=(
        click.Argument(["scenes"], nargs=-1, type=click.Path(path_type=Path)),
        click.Option(["--full3d"], is_flag=True, help="Confirm the first crossing of SCENES on whole bodies."),
    ),
)
