"""Report of the paper study as Markdown and as one self-contained HTML file, rendered from its rows and runs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from studies.models.session import SCENE_FILE
from studies.paper import audit as paper_audit
from studies.paper import bond_tables as paper_bond_tables
from studies.paper import summary as paper_summary
from studies.paper import tables as paper_tables
from studies.paper import time_tables as paper_time_tables
from studies.paper import variant_tables as paper_variant_tables
from studies.paper.claims import claims
from studies.paper.pictures import STATES, draw_all
from studies.paper.results import CaseResult, PaperResults
from studies.report import scene_tables
from studies.report.numbers import duration
from studies.report.pages import write_page
from studies.report.scene_report import SceneReport
from studies.report.tables import Table
from studies.results.rows import write_rows

TITLE: Final = "The paper's four actuators: closed form beside finite elements, ANSYS and test"


def write_paper_report(
    folder: Path,
    results: PaperResults,
    provenance: Mapping[str, str],
    wall_s: Mapping[str, float],
    pictures: Mapping[str, str] | None = None,
) -> Path:
    """Write report.md, report.html, rows.csv and pictures/.

    Parameters
    ----------
    folder
        Where to; made if missing.
    results
        What has been run; what has not is shown as missing.
    provenance
        Commit, versions, BLAS, machine, date: by the name shown.
    wall_s
        Wall time, s: ``total`` of the study, ``closed form`` of all its closed-form answers; either may be missing.
    pictures
        Relative addresses by name, or why there is no picture; default those of `draw_all`.

    Returns
    -------
    Path
        report.html.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_rows(folder / "rows.csv", results.rows)
    drawn = draw_all(folder, results) if pictures is None else pictures
    return write_page(folder, "paper.md.j2", _content(results, provenance, wall_s, drawn))


def _content(
    results: PaperResults, provenance: Mapping[str, str], wall_s: Mapping[str, float], pictures: Mapping[str, str]
) -> dict[str, Any]:
    """What the template shows."""
    found = claims(results)
    lines = tuple((f"{number}", claim.text, claim.finding, claim.verdict) for number, claim in enumerate(found, 1))
    return {
        "title": TITLE,
        "answers": paper_tables.answers(results),
        "in_short": paper_summary.in_short(results, found),
        "acceptance": paper_audit.acceptance(results),
        "misses": paper_audit.misses(results),
        "closed_form_errors": paper_tables.closed_form_errors(results),
        "model_errors": paper_tables.model_errors(results),
        "printed_errors": paper_tables.printed_errors(results),
        "mean_errors": paper_tables.mean_errors(results),
        "assumptions": paper_tables.assumptions(results),
        "unfoldings": paper_tables.unfoldings(results),
        "claims": Table(("", "the paper says", "the rows say", "verdict"), lines, left=(1, 2, 3)),
        "dimension_swing": paper_variant_tables.dimension_swing(results),
        "conventions": paper_variant_tables.conventions(results),
        "silicones": paper_variant_tables.silicones(results),
        "silicone_effects": paper_variant_tables.silicone_effects(results),
        "rings": paper_variant_tables.rings(results),
        "bonds": paper_bond_tables.bonds(results),
        "bond_verdicts": paper_bond_tables.verdicts(results),
        "beyond": paper_variant_tables.beyond(results),
        "stretches": paper_variant_tables.stretches(results),
        "blocked": paper_variant_tables.blocked(results),
        "by_model": paper_time_tables.by_model(results, wall_s),
        "core_wall": duration(paper_time_tables.core_seconds(results)),
        "split": paper_time_tables.split(results),
        "work": paper_time_tables.work(results),
        "levels": [(case.case.name, scene_tables.convergence(_report_of(case))) for case in results.of("core", "tets")],
        "stops": paper_summary.stops(results),
        "notes": paper_summary.notes(results),
        "provenance": scene_tables.provenance([_report_of(case) for case in results.cases], provenance),
        "wall": duration(wall_s["total"]) if "total" in wall_s else "",
        "pictures": dict(pictures),
        "states": {name.removeprefix(STATES): name for name in pictures if name.startswith(STATES)},
    }


def _report_of(case: CaseResult) -> SceneReport:
    """A case as the tables of scene reports take it."""
    result, file = case.result, case.folder / SCENE_FILE
    runs = result.runs
    return SceneReport(
        name=case.case.name,
        title=result.scene.title,
        scene_toml=file.read_text(encoding="utf-8") if file.exists() else "",
        pressures_kpa=tuple(result.scene.load.pressure_kpa),
        rows=result.rows,
        runs=tuple(run.summary for run in runs),
        paths={f"{run.summary.model} {run.summary.level}": list(run.path) for run in runs},
        fields={},
        notes=(),
    )
