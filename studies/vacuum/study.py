"""The vacuum study: what bellows contract to when their cavity is evacuated, with contact of their folds.

python -m studies.vacuum.study --out results/vacuum
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
from mpi4py import MPI

from studies.contact.study import at
from studies.models.axisymmetric import run_axisymmetric
from studies.models.contact import CONTACT_FILE, MODELLED, read_reports
from studies.progress import Progress
from studies.report.pages import write_page
from studies.report.tables import Table
from studies.results import provenance
from studies.results.rows import REACHED, Row, row, write_rows
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows
from studies.vacuum.plots import draw_contractions, draw_shapes

SCENES = provenance.ROOT / "scenes" / "vacuum"
LEVELS = (1, 2)
STOPPED = 3


def scenes() -> list[BellowsScene]:
    """Scenes of the study, by name."""
    return [load_bellows(path) for path in sorted(SCENES.glob("*.toml"))]


def run_folder(out: Path, scene: BellowsScene, level: int) -> Path:
    """Where a run is kept."""
    return out / scene.name / f"axisymmetric-r{level}"


def scene_rows(out: Path, scene: BellowsScene, runs: Sequence[Run]) -> list[Row]:
    """Rows of a scene: contraction, gap, contact force, modes at each requested pressure, and where stability is lost.

    The reference of a level is the finest one.
    """
    rows: list[Row] = []
    for run in runs:
        level = run.summary.level
        reports = read_reports(run_folder(out, scene, int(level[1:])) / CONTACT_FILE)
        for pressure in scene.load.pressure_kpa:
            found, finest = at(run, pressure), at(runs[-1], pressure)

            def entry(quantity: str, unit: str, value: float, reference: float = math.nan, p: float = pressure,
                      of: Run = run, status: str = REACHED) -> Row:  # fmt: skip
                source = "" if math.isnan(reference) else f"axisymmetric {runs[-1].summary.level}"
                return row(scene.name, quantity, unit, p, "axisymmetric", value, of.summary.level,
                           reference=reference, source=source, status=status)  # fmt: skip

            if found is None:
                stopped = f"stopped at {run.path[-1].pressure_kpa:.3f} kPa: {run.summary.reason}"
                rows.append(entry("tip_mm", "mm", math.nan, status=stopped))
                continue
            here = [r for r in reports if math.isclose(float(r["pressure_kpa"]), pressure, rel_tol=1e-5)]
            other = finest.tip_mm if finest is not None and run is not runs[-1] else math.nan
            rows += [
                entry("tip_mm", "mm", found.tip_mm, other),
                entry("volume_mm3", "mm3", found.volume_mm3),
                entry("min_gap_mm", "mm", found.min_gap_mm),
                entry("contact_force_n", "N", sum(float(r["force_n"]) for r in here)),
                entry("unstable_modes", "1", found.unstable_modes),
                entry("min_det_f", "1", found.min_det_f),
            ]
        if len(run.path) > 1:
            work, energy = pressure_work_mj(run), run.path[-1].energy_mj - run.path[0].energy_mj
            last = run.path[-1].pressure_kpa
            rows.append(row(scene.name, "pressure_work_mj", "mJ", last, "axisymmetric", work, level, reference=energy,
                            source="gain of stored energy from the first state"))  # fmt: skip
        crossing = run.summary.crossing
        if crossing:
            name = str(crossing["kind"]).replace(" ", "_")
            rows.append(
                row(scene.name, f"{name}_kpa", "kPa", math.nan, "axisymmetric", crossing["pressure_kpa"], level)
            )
    return rows


def pressure_work_mj(run: Run) -> float:
    """Work of the pressure from the first state of a path to its last, by the trapezoidal rule, mJ.

    It is stored whatever touches on the way, up to the rule's error: contact without friction takes none.
    """
    pressure = 1e-3 * np.array([entry.pressure_kpa for entry in run.path])
    volume = np.array([entry.volume_mm3 for entry in run.path])
    return float(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))


def contraction_table(rows: Sequence[Row], scene: BellowsScene) -> Table:
    """A line per requested pressure."""
    value = {(r.level, r.pressure_kpa, r.quantity): r.value for r in rows}
    levels = list(dict.fromkeys(r.level for r in rows))

    def cell(level: str, pressure: float, quantity: str, digits: int) -> str:
        found = value.get((level, pressure, quantity), math.nan)
        return "" if math.isnan(found) else f"{found:.{digits}g}"

    lines = [
        (
            f"{p:g}",
            *(cell(level, p, "tip_mm", 5) for level in levels),
            *(cell(levels[-1], p, name, 3) for name in ("min_gap_mm", "contact_force_n")),
            *(cell(level, p, "unstable_modes", 3) for level in levels),
            cell(levels[-1], p, "min_det_f", 2),
        )
        for p in scene.load.pressure_kpa
    ]
    header = (
        "kPa", *(f"tip, mm: {level}" for level in levels), f"least gap, mm: {levels[-1]}",
        f"contact force, N: {levels[-1]}", *(f"unstable modes: {level}" for level in levels), "least det F",
    )  # fmt: skip
    return Table(header, tuple(lines), ())


def _notes(run: Run) -> list[str]:
    """First touch, loss of stability and end of a run, in words."""
    name = f"r{run.summary.level[1:]}"
    found = [f"{name}: {note}" for note in run.summary.plan if note.startswith(MODELLED)]
    crossing = run.summary.crossing
    if crossing:
        found.append(
            f"{name}: {crossing['kind']} at {crossing['pressure_kpa']:.4g} kPa (within {crossing['within_kpa']:.1g}), "
            f"unstable axisymmetric modes {crossing['modes_before']} -> {crossing['modes_after']}"
        )
    if run.summary.reason:
        found.append(f"{name}: {run.summary.reason}")
    if len(run.path) > 1:
        gain = run.path[-1].energy_mj - run.path[0].energy_mj
        found.append(
            f"{name}: {len(run.path)} states, {run.summary.factorisations} factorisations; work of the pressure by the "
            f"trapezoidal rule {pressure_work_mj(run):.4g} mJ, gain of stored energy {gain:.4g} mJ"
        )
    return found


def write_study(out: Path, levels: Sequence[int], progress: Progress) -> tuple[Path, bool]:
    """Solve what is missing, write rows, pictures and report; its path, and whether all states were reached."""
    rows: list[Row] = []
    sections: list[dict[str, Any]] = []
    curves = {}
    (out / "pictures").mkdir(parents=True, exist_ok=True)
    for scene in scenes():
        runs = [run_axisymmetric(scene, n, run_folder(out, scene, n), MPI.COMM_WORLD, progress) for n in levels]
        found = scene_rows(out, scene, runs)
        rows += found
        picture = f"pictures/{scene.name}.png"
        draw_shapes(out / picture, scene, runs[0], run_folder(out, scene, levels[0]))
        path = [(0.0, 0.0), *((entry.pressure_kpa, entry.tip_mm) for entry in runs[-1].path)]
        curves[scene.name] = np.array(path)
        sections.append(
            {
                "name": scene.name,
                "title": scene.title,
                "table": contraction_table(found, scene),
                "notes": [note for run in runs for note in _notes(run)],
                "picture": picture,
                "level": runs[0].summary.level,
            }
        )
    draw_contractions(out / "pictures" / "contractions.png", curves)
    write_rows(out / "rows.csv", rows)
    facts = {"commit": provenance.commit(), "date": provenance.now(), "machine": provenance.machine()}
    content = {"title": "Bellows under vacuum", "sections": sections, "facts": facts}
    return write_page(out, "vacuum.md.j2", content), all(r.status == REACHED for r in rows)


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for runs, rows and report.")
@click.option("--level", multiple=True, type=int, default=LEVELS, show_default=True, help="Meridian refinements.")
def main(out: Path, level: tuple[int, ...]) -> None:
    """Contraction of bellows whose cavity is evacuated, with contact of their folds."""
    out.mkdir(parents=True, exist_ok=True)
    report, reached = write_study(out, sorted(level), Progress(MPI.COMM_WORLD))
    click.echo(f"report: {report}")
    if not reached:
        sys.exit(STOPPED)


if __name__ == "__main__":
    main()
