"""The outline study: finite elements of one outline after another, and the gap to the closed form split into causes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import PRESSURES_KPA, printed_mm
from analytical.bellows.paper import PaperActuator, actuators
from studies.engine import Bar, Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.outline.cases import MOULDED, OUTLINES, ZIGZAG, Case, cases, with_outline
from studies.outline.folds import FOLDS, fold_rows
from studies.outline.plots import draw_waterfalls
from studies.outline.split import LEVELS, Split, splits
from studies.outline.tables import (
    assumptions_table,
    both_ends_table,
    direct_table,
    held_table,
    sentence_figures,
    split_table,
)
from studies.report.numbers import signed
from studies.report.tables import Table, table_of
from studies.results import provenance
from studies.results.bellows_rows import bellows_rows
from studies.results.closed_form_rows import fed_mm, free_wall_mm
from studies.results.kept import content_key, kept
from studies.results.measured_rows import measured_rows
from studies.results.rows import Row, is_reached, row
from studies.scene.bellows import shape_of
from studies.scene.load import load_bellows

SHOWN: Final = ("tip_mm", "root_stretch_outer", "wall_stretch", "wall_hoop_stretch_middle", "unstable_modes")


def solve(case: Case, at: Setting) -> tuple[Row, ...]:
    """Rows of a case on two meridians: tips with their bands, and stretches measured in the states."""
    if case.fault:
        return (row(case.name, "tip_mm", "mm", math.nan, "axisymmetric", math.nan, status=f"refused: {case.fault}"),)
    folder = at.out / case.name
    runs = [run_axisymmetric(case.scene, n, folder / f"axisymmetric-r{n}", at.comm, at.progress) for n in LEVELS]
    key = content_key([run.summary.content_hash for run in runs], provenance.code_hash(), SHOWN, FOLDS)

    def rows() -> tuple[Row, ...]:
        found = [*bellows_rows(case.scene, runs), *measured_rows(case.scene, runs, folder)]
        shown = [r for r in found if r.quantity in SHOWN and r.model == "axisymmetric"]
        return (*shown, *fold_rows(case.scene, runs, folder))

    return kept(folder / "rows.json", key, tuple[Row, ...], rows)


def value_of(rows: Sequence[Row], scene: str, pressure_kpa: float) -> Row | None:
    """Tip of the finest mesh of a scene at a pressure."""
    found = [r for r in rows if (r.scene, r.quantity, r.pressure_kpa) == (scene, "tip_mm", pressure_kpa)]
    return found[-1] if found else None


def summary_table(rows: Sequence[Row]) -> Table:
    """Elongations at all pressures of both outlines and of the closed form, and the printed ones."""

    def tips(actuator: PaperActuator, outline: str) -> str:
        found = (value_of(rows, f"{actuator.name}-{outline}", p) for p in PRESSURES_KPA)
        return ", ".join(f"{r.value:.1f}" if r is not None else "–" for r in found)

    columns: dict[str, Callable[[PaperActuator], str]] = {
        "actuator": lambda a: a.name,
        "finite elements, as moulded": lambda a: tips(a, MOULDED.name),
        "finite elements, near the zigzag": lambda a: tips(a, ZIGZAG.name),
        "closed form": lambda a: ", ".join(
            f"{u:.1f}" for u in closed_form(a.dimensions, a.law, PRESSURES_KPA).elongation_mm
        ),
        "paper at 20 kPa: closed form, ANSYS, test": lambda a: ", ".join(f"{u:g}" for u in printed_mm(a).values()),
    }
    return table_of(actuators(), columns, left=(0,))


def outlines_table(rows: Sequence[Row], actuator: PaperActuator) -> Table:
    """A line per outline, a column per pressure: elongation, its difference from the closed form."""
    chain = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA).elongation_mm
    lines = [("closed form, straight walls from root to crest", *(f"{value:.1f}" for value in chain))]
    for outline in OUTLINES:
        cells = []
        for pressure, known in zip(PRESSURES_KPA, chain, strict=True):
            found = value_of(rows, f"{actuator.name}-{outline.name}", pressure)
            reached = found is not None and is_reached(found)
            cells.append(
                f"{found.value:.1f} ({signed(100.0 * (known / found.value - 1.0))} %)" if found and reached else "–"
            )
        lines.append((outline.text, *cells))
    return Table(("outline", *(f"{p:g} kPa" for p in PRESSURES_KPA)), tuple(lines))


def fed_table() -> Table:
    """Wall lengths, and the closed form fed with each of both outlines."""
    lines = []
    for actuator in actuators():
        base = load_bellows(provenance.ROOT / "scenes" / f"{actuator.name}.toml")
        for outline in (MOULDED, ZIGZAG):
            scene = with_outline(base, actuator, outline)
            shape = shape_of(scene)
            length, straight = free_wall_mm(shape) + 0.5 * shape.seat_mm, actuator.dimensions.side_length_mm
            fed = [fed_mm(scene, pressure) for pressure in PRESSURES_KPA]
            lines.append(
                (
                    actuator.name,
                    outline.text,
                    f"{length:.2f} ({signed(100.0 * (length / straight - 1.0))} %)",
                    ", ".join(f"{whole:.1f}" for whole, _ in fed),
                    ", ".join(f"{less:.1f}" for _, less in fed),
                )
            )
    fed_at = "closed form fed with it at 5, 10, 15, 20 kPa, mm"
    header = ("actuator", "outline", "centreline of a half pitch, mm (against l)", fed_at, "less its slack at rest, mm")
    return Table(header, tuple(lines), left=(0, 1, 3, 4))


def rows_of_split(found: Split) -> list[Row]:
    """A row per cause, with its band, and what they leave over."""
    p, name = found.pressure_kpa, found.actuator.name
    rows = [
        row(name, f"gap_{cause}_mm", "mm", p, "closed_form", part.value, uncertainty=part.band)
        for cause, part in found.causes.items()
    ]
    return [*rows, row(name, "gap_left_over_mm", "mm", p, "closed_form", found.left_over_mm)]


def page(solved: Sequence[Solved[Case, tuple[Row, ...]]], at: Setting) -> Page:
    """Tables of all outlines, the split with its picture, and the bar that its causes sum to the gap."""
    rows = [r for done in solved for r in done.result]
    by_actuator = {actuator.name: splits(rows, actuator) for actuator in actuators()}
    found = [s for of_it in by_actuator.values() for s in of_it]
    direct = [s for actuator in actuators() for s in splits(rows, actuator, (MOULDED,))]
    pictures = {name: f"pictures/gap-{name}.png" for name in by_actuator}
    for name, of_it in by_actuator.items():
        draw_waterfalls(at.out / pictures[name], of_it)
    content = {
        "summary": summary_table(rows),
        "outlines": {a.name: outlines_table(rows, a) for a in actuators()},
        "split": {name: split_table(of_it) for name, of_it in by_actuator.items()},
        "both_ends": both_ends_table(found),
        "direct": direct_table(direct),
        "assumptions": assumptions_table(rows),
        "held": held_table(rows),
        "figures": sentence_figures(rows, found),
        "fed": fed_table(),
        "pictures": pictures,
        "refused": [f"{done.case.name}: {done.case.fault}" for done in solved if done.case.fault],
    }
    stopped = [f"{r.scene}, {r.level}: {r.status}" for r in rows if not is_reached(r) and "refused" not in r.status]
    bars = [
        sum_bar("causes, each found on its own, sum to the gap within its band", found),
        sum_bar("the same of the causes measured in the outline as moulded alone", direct, decides=False),
    ]
    return Page([*rows, *(r for s in found for r in rows_of_split(s))], content, stopped, bars)


def sum_bar(wanted: str, found: Sequence[Split], decides: bool = True) -> Bar:
    """Whether the causes sum to the gap at all states; a state that is missing does not."""
    known, left = sum(s.sums_up for s in found), [abs(s.left_over_mm) for s in found if math.isfinite(s.left_over_mm)]
    text = f"{known} of {len(found)} gaps" + (f", at most {max(left):.2f} mm left over" if left else "")
    return Bar(wanted, text, known == len(found), decides)


STUDY: Final = Study(
    name="outline",
    title="The gap between closed form and finite elements: outline and model apart",
    question="How much of the gap is the outline that is meshed, and how much the closed form's mechanics?",
    template="outline/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
)
