"""The imperfection study: actuators whose moulding core sat off the axis, in full 3D: how far they bend.

``python -m studies.imperfection.study --out results/imperfection`` runs what is not there yet and writes rows,
curves, pictures of the bent shapes and the report. Runs are kept under the hash of what decides their numbers, with a
checkpoint after each step, so a study that was stopped goes on and a finished one only draws.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import click
import numpy as np
from mpi4py import MPI

from studies.models.axisymmetric import run_axisymmetric
from studies.models.build import TipPose, tip_pose
from studies.models.full3d import run_full3d
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.report.labels import level_label
from studies.report.numbers import duration
from studies.report.pages import write_page
from studies.report.panels import Panel, Series, draw_panels
from studies.report.pictures.bent import Bent, draw_bent
from studies.report.style import ABOVE, BLACK, BLUE, ORANGE, VERMILION
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.results.files import load_state
from studies.results.rows import REACHED, Row, row, write_rows
from studies.results.runs import Run, tip_at
from studies.scene.bellows import BellowsScene, core_shift_mm
from studies.scene.files import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

TITLE: Final = "An eccentric core: how far the actuator bends and what it does to the elongation"
SHARES: Final = (0.0, 0.05, 0.10)
LOOKS: Final = {
    0.0: {"color": BLACK, "marker": "o"},
    0.05: {"color": ORANGE, "marker": "s"},
    0.10: {"color": VERMILION, "marker": "D"},
}


@dataclass(frozen=True)
class Case:
    """A base scene, its pressures in kPa, and its meshes, coarsest first; only 10 % is solved on all of them."""

    file: str
    pressures_kpa: tuple[float, ...]
    levels: tuple[BodyLevel, ...]


CASES: Final = (
    Case(
        "scenes/imperfection/short-core-10.toml",
        (1.25, 2.5, 5.0, 7.5, 10.0),
        (BodyLevel(8, 1), BodyLevel(12, 1), BodyLevel(8, 2)),
    ),
    Case("scenes/heung-t2-ri5.toml", (5.0, 10.0, 15.0, 20.0), (BodyLevel(8, 1),)),
)


@dataclass(frozen=True)
class Found:
    """A run and where the tip stands in its states, by pressure in kPa."""

    scene: BellowsScene
    share: float
    level: BodyLevel
    folder: Path
    run: Run
    poses: dict[float, TipPose]

    def tip_mm(self, pressure_kpa: float) -> float:
        """Elongation at a requested pressure; NaN if it was not reached."""
        return tip_at(self.run, pressure_kpa)


def scene_of(case: Case, share: float) -> BellowsScene:
    """The scene of a case with a core off the axis by a share of the wall."""
    base = load_bellows(provenance.ROOT / case.file)
    name = f"{Path(case.file).stem.removesuffix('-core-10')}-e{100.0 * share:02.0f}"
    return base.model_copy(
        update={
            "name": name,
            "geometry": base.geometry.model_copy(update={"eccentricity": share}),
            "load": base.load.model_copy(update={"pressure_kpa": list(case.pressures_kpa)}),
            "ask": base.ask.model_copy(update={"fields": False}),
        }
    )


def run_case(case: Case, share: float, level: BodyLevel, folder: Path, comm: MPI.Comm, progress: Progress) -> Found:
    """A run of a case; every rank calls. What is there of the same content is used."""
    scene = scene_of(case, share)
    base = folder / Path(case.file).stem
    centred = base / f"axisymmetric-r{level.meridian}"
    run_axisymmetric(scene, level.meridian, centred, comm, progress)
    place = base / f"{scene.name}-{level.name}"
    run = run_full3d(scene, "full3d", level, centred, place, comm, progress, ())
    poses = {}
    if comm.rank == 0:
        meridian = scene_meridian(scene, level.meridian)
        body = scene_body(meridian, "full3d", level.around, core_shift_mm(scene))
        for pressure in case.pressures_kpa:
            saved = load_state(place, run.summary.content_hash, 1e-3 * pressure)
            if saved is not None:
                poses[pressure] = tip_pose(body, saved[0])
    return Found(scene, share, level, place, run, poses)


def run_study(folder: Path, comm: MPI.Comm, cases: Sequence[Case] = CASES) -> list[tuple[Case, list[Found]]]:
    """All runs, coarsest mesh first; every rank calls."""
    progress = Progress(comm)
    out = []
    for case in cases:
        found = [run_case(case, share, case.levels[0], folder, comm, progress) for share in SHARES]
        found += [run_case(case, SHARES[-1], level, folder, comm, progress) for level in case.levels[1:]]
        out.append((case, found))
    return out


# --- rows -----------------------------------------------------------------------------------


def rows_of(case: Case, found: Sequence[Found]) -> list[Row]:
    """Rows of a case: each tip beside the centred one on the same mesh, each bend beside the one in proportion."""
    rows = []
    first = found[: len(SHARES)]
    for pressure in case.pressures_kpa:
        for item in found:
            rows += _rows_at(item, pressure, first)
    return rows


def _rows_at(item: Found, pressure: float, first: Sequence[Found]) -> list[Row]:
    same_mesh = item in first
    tip, pose = item.tip_mm(pressure), item.poses.get(pressure)
    status = REACHED if pose is not None else f"stopped: {item.run.summary.reason}"
    name, level = item.scene.name, item.level.name
    centred = first[0].tip_mm(pressure) if same_mesh else math.nan
    source = "core centred, same mesh" if same_mesh else ""
    rows = [row(name, "tip_mm", "mm", pressure, "full3d", tip, level, reference=centred, source=source, status=status)]
    small = first[1].poses.get(pressure)
    for quantity, unit in (("bend_deg", "degree"), ("sideways_mm", "mm")):
        value = math.nan if pose is None else getattr(pose, quantity)
        wanted, why = math.nan, ""
        if same_mesh and item.share > SHARES[1] and small is not None:
            wanted = getattr(small, quantity) * item.share / SHARES[1]
            why = f"in proportion to {100.0 * SHARES[1]:g} %"
        elif not same_mesh and first[-1].poses.get(pressure) is not None:
            wanted, why = getattr(first[-1].poses[pressure], quantity), first[-1].level.name
        rows.append(
            row(name, f"tip_{quantity}", unit, pressure, "full3d", value, level, reference=wanted, source=why,
                status=status)
        )  # fmt: skip
    state = item.run.at(pressure)
    modes = state.unstable_modes if state else math.nan
    rows.append(row(name, "unstable_modes", "", pressure, "full3d", modes, level, status=status))
    return rows


# --- report ---------------------------------------------------------------------------------


def _table(case: Case, found: Sequence[Found]) -> Table:
    lines = []
    first = found[: len(SHARES)]
    for pressure in case.pressures_kpa:
        for item in found:
            pose = item.poses.get(pressure)
            if pose is None:
                lines.append((f"{pressure:g}", f"{100 * item.share:g}", level_label(item.level.name), *["–"] * 5))
                continue
            change = item.tip_mm(pressure) / first[0].tip_mm(pressure) - 1.0 if item in first else math.nan
            modes = [r.unstable_modes for r in item.run.path if math.isclose(r.pressure_kpa, pressure)][0]
            lines.append(
                (
                    f"{pressure:g}",
                    f"{100.0 * item.share:g}",
                    level_label(item.level.name),
                    f"{item.tip_mm(pressure):.3f}",
                    "–" if math.isnan(change) else f"{100.0 * change:+.3f}",
                    f"{pose.bend_deg:.3f}",
                    f"{pose.sideways_mm:.3f}",
                    f"{modes:.0f}",
                )
            )
    header = (
        "kPa",
        "core off, % of t",
        "mesh",
        "tip, mm",
        "change, %",
        "bend, degree",
        "sideways, mm",
        "unstable modes",
    )
    return Table(header, tuple(lines), left=())


def _orders(case: Case, found: Sequence[Found]) -> str:
    """Observed orders of bend and of the change of the tip between 5 and 10 %, a sentence."""
    centred, small, large = found[: len(SHARES)]
    bend, tip = [], []
    for p in case.pressures_kpa:
        if p in small.poses and p in large.poses:
            bend.append(math.log2(large.poses[p].bend_deg / small.poses[p].bend_deg))
            tip.append(math.log2((large.tip_mm(p) - centred.tip_mm(p)) / (small.tip_mm(p) - centred.tip_mm(p))))
    if not bend:
        return "no pressure was reached by all."
    return (
        f"from 5 to 10 % the bend grows with order {min(bend):.3f} to {max(bend):.3f} of the eccentricity, the change "
        f"of the elongation with order {min(tip):.2f} to {max(tip):.2f} (1 and 2 expected of a small one)."
    )


def _summary(case: Case, found: Sequence[Found]) -> str:
    """What the most eccentric core does at the highest pressure that was reached, a sentence."""
    centred, worst = found[0], found[len(SHARES) - 1]
    if not worst.poses:
        return "no pressure was reached."
    pressure = max(worst.poses)
    pose, change = worst.poses[pressure], worst.tip_mm(pressure) / centred.tip_mm(pressure) - 1.0
    return (
        f"at {pressure:g} kPa a core off by {100.0 * worst.share:g} % of the wall ({core_shift_mm(worst.scene):g} mm) "
        f"bends the tip by {abs(pose.bend_deg):.1f} degrees, moves it sideways by {abs(pose.sideways_mm):.1f} mm and "
        f"changes the elongation by {100.0 * change:+.2f} %."
    )


def _draw_curves(path: Path, cases: Sequence[tuple[Case, list[Found]]]) -> None:
    """Draw bend above change of elongation, a column per case."""
    columns = [(_bends(case, found), _changes(case, found)) for case, found in cases]
    panels = [list(line) for line in zip(*columns, strict=True)]
    panels[0][0] = dataclasses.replace(panels[0][0], y_label="bend of the tip, degree")
    panels[1][0] = dataclasses.replace(panels[1][0], y_label="change of the elongation, %")
    legend = {**ABOVE, "ncols": 2, "fontsize": 8}
    draw_panels(path, panels, (4.2 * len(cases), 6.0), legend, sharex="col")


def _bends(case: Case, found: Sequence[Found]) -> Panel:
    """Bend of the tip over the pressure, on the first mesh as lines, on others as marks."""
    series = []
    for item in found[: len(SHARES)]:
        reached = [p for p in case.pressures_kpa if p in item.poses]
        bends = [item.poses[p].bend_deg for p in reached]
        label = f"core off by {100.0 * item.share:g} % of t"
        series.append(Series([0.0, *reached], [0.0, *bends], LOOKS[item.share], label))
    for item in found[len(SHARES) :]:
        look = {"marker": "+" if item.level.meridian > 1 else "x", "linestyle": "none", "color": BLUE}
        reached = sorted(item.poses)
        label = f"the same, {level_label(item.level.name)}"
        series.append(Series(reached, [item.poses[p].bend_deg for p in reached], look, label))
    return Panel(series, title=Path(case.file).stem.removesuffix("-core-10"))


def _changes(case: Case, found: Sequence[Found]) -> Panel:
    """Change of the elongation against the centred core over the pressure."""
    centred, series = found[0], []
    for item in found[1 : len(SHARES)]:
        reached = [p for p in case.pressures_kpa if p in item.poses]
        change = [100.0 * (item.tip_mm(p) / centred.tip_mm(p) - 1.0) for p in reached]
        series.append(Series(reached, change, LOOKS[item.share]))
    return Panel(series, "pressure, kPa")


def _draw_shapes(folder: Path, cases: Sequence[tuple[Case, list[Found]]]) -> list[str]:
    """Pictures of the most bent states of each case, centred and at 10 %."""
    places = []
    for case, found in cases:
        states = []
        for item in (found[0], found[len(SHARES) - 1]):
            if not item.poses:
                continue
            pressure = max(item.poses)
            meridian = scene_meridian(item.scene, item.level.meridian)
            body = scene_body(meridian, "full3d", item.level.around, core_shift_mm(item.scene))
            saved = load_state(item.folder, item.run.summary.content_hash, 1e-3 * pressure)
            if saved is not None:
                label = f"{item.scene.name}: core off by {100.0 * item.share:g} % of t, {pressure:g} kPa"
                states.append(Bent(label, item.scene, meridian, body, saved[0]))
        if states:
            name = f"pictures/bent-{Path(case.file).stem.removesuffix('-core-10')}.png"
            (folder / "pictures").mkdir(parents=True, exist_ok=True)
            draw_bent(folder / name, states)
            places.append(name)
    return places


def write_report(folder: Path, cases: Sequence[tuple[Case, list[Found]]]) -> Path:
    """Write rows.csv, pictures and report; one rank calls. Returns report.html."""
    write_rows(folder / "rows.csv", [r for case, found in cases for r in rows_of(case, found)])
    _draw_curves(folder / "pictures" / "bend.png", cases)
    everything = [item for _, found in cases for item in found]
    stamps = {
        "commit": ", ".join(dict.fromkeys(item.run.summary.commit for item in everything)),
        "date": everything[-1].run.summary.when,
        "machine": provenance.machine(),
        **provenance.versions(),
    }
    content = {
        "title": TITLE,
        "cases": [
            {
                "name": Path(case.file).stem.removesuffix("-core-10"),
                "title": found[0].scene.title,
                "table": _table(case, found),
                "orders": _orders(case, found),
                "summary": _summary(case, found),
                "stopped": [f"{i.scene.name}: {i.run.summary.reason}" for i in found if i.run.summary.reason],
            }
            for case, found in cases
        ],
        "pictures": _draw_shapes(folder, cases),
        "seconds": duration(float(np.sum([item.run.summary.time_s["total"] for item in everything]))),
        "provenance": facts_table(stamps),
    }
    return write_page(folder, "imperfection.md.j2", content)


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for runs and report.")
@click.option("--short", is_flag=True, help="Only the short actuator.")
def main(out: Path, short: bool) -> None:
    """Bend and elongation of actuators whose moulding core sat off the axis; writes rows and report."""
    comm = MPI.COMM_WORLD
    chosen = CASES[:1] if short else CASES
    found = run_study(out, comm, [dataclasses.replace(case) for case in chosen])
    if comm.rank == 0:
        click.echo(f"report: {write_report(out, found)}")


if __name__ == "__main__":
    main()
