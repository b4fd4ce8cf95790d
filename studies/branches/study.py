"""The branch study: paths whose volume turns back, and branches beyond buckling.

``python -m studies.branches.study --out results/branches`` solves the cases that are not there yet and writes rows,
curves and the report. A case is kept under a hash of all that decides its numbers, so a second study only draws.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import click
from mpi4py import MPI

from studies.branches.cases import CASES, ON_ALL_RANKS, SOURCES, CaseResult, Fact, Point
from studies.report.numbers import count, duration, number_text
from studies.report.pages import write_page
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import BLACK, BLUE, INSIDE, ORANGE, VERMILION
from studies.report.tables import Table, facts_table, table_of
from studies.results import provenance
from studies.results.files import write_text_atomically
from studies.results.rows import Row, row, write_rows

TITLE: Final = "Beyond limit points and bifurcations: paths by arc length, branches, a bellows that squirms"
CASES_FOLDER: Final = "cases"
COLOURS: Final = (BLUE, VERMILION, ORANGE)
# What a case is drawn over, and its ordinate.
AXES: Final[dict[str, tuple[str, str]]] = {
    "two-spheres": ("volume of both, mm³", "pressure, kPa"),
    "cube": ("stretch", "tension, kPa"),
    "ring": ("outward move of the long axis, of the radius", "outside pressure, kPa"),
    "blocked-bellows": ("pressure, kPa", "force on the blocked tip, N"),
}


def case_hash(name: str) -> str:
    """Hash of all that decides a case's numbers."""
    parts = [path.read_bytes() for path in SOURCES]
    text = json.dumps([name, provenance.code_hash(), hashlib.sha256(b"".join(parts)).hexdigest()])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def read_case(folder: Path, name: str) -> tuple[CaseResult, dict[str, str]] | None:
    """A case and its stamp, if it is there, whole and of this content."""
    try:
        data: dict[str, Any] = json.loads((folder / CASES_FOLDER / f"{name}.json").read_text(encoding="utf-8"))
        if data["content_hash"] != case_hash(name):
            return None
        kept = data["case"]
        points = tuple(Point(**_numbers(p)) for p in kept["points"])
        facts = tuple(Fact(**_numbers(f)) for f in kept["facts"])
        return CaseResult(kept["name"], points, facts, kept["unknowns"], kept["seconds"]), data["stamp"]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _numbers(entry: dict[str, Any]) -> dict[str, Any]:
    return {key: math.nan if value is None else value for key, value in entry.items()}


def _write_case(folder: Path, result: CaseResult, stamp: dict[str, str]) -> None:
    kept = asdict(result)
    for part in ("points", "facts"):
        kept[part] = [
            {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in entry.items()} for entry in kept[part]
        ]
    data = {"content_hash": case_hash(result.name), "stamp": stamp, "case": kept}
    (folder / CASES_FOLDER).mkdir(parents=True, exist_ok=True)
    write_text_atomically(folder / CASES_FOLDER / f"{result.name}.json", json.dumps(data, indent=1) + "\n")


def run_study(folder: Path, comm: MPI.Comm, names: Sequence[str]) -> list[tuple[CaseResult, dict[str, str]]]:
    """Solve what is missing; every rank calls, rank 0 gets the results."""
    out = []
    for name in names:
        found = comm.bcast(read_case(folder, name) if comm.rank == 0 else None)
        if found is None:
            result = None
            if comm.rank == 0 or name in ON_ALL_RANKS:
                result = CASES[name](comm)
            if comm.rank == 0 and result is not None:
                stamp = {"commit": provenance.commit(), "date": provenance.now(), "ranks": str(comm.size)}
                _write_case(folder, result, stamp)
                found = result, stamp
        if found is not None:
            out.append(found)
    return out


# --- rows and report ------------------------------------------------------------------------


def rows_of(result: CaseResult) -> list[Row]:
    """Rows of a case: its facts, and each state whose load is known exactly."""
    rows = [
        row(result.name, f.quantity, f.unit, math.nan, "fem", f.value, reference=f.reference, source=f.source)
        for f in result.facts
    ]
    for p in result.points:
        exact = not math.isnan(p.exact_kpa)
        rows.append(
            row(result.name, "load_kpa", "kPa", p.load_kpa, "fem", p.load_kpa, p.branch, reference=p.exact_kpa,
                source=f"exact at {p.move:.6g}" if exact else "")
        )  # fmt: skip
        rows.append(row(result.name, "unstable_modes", "", p.load_kpa, "fem", float(p.unstable), p.branch))
        if not math.isnan(p.force_n):
            rows.append(row(result.name, "tip_force_n", "N", p.load_kpa, "fem", p.force_n, p.branch))
            rows.append(row(result.name, "sideways_mm", "mm", p.load_kpa, "fem", p.move, p.branch))
    return rows


def _branches(result: CaseResult) -> dict[str, list[Point]]:
    out: dict[str, list[Point]] = {}
    for point in result.points:
        out.setdefault(point.branch, []).append(point)
    return out


def _branch_table(result: CaseResult) -> Table:
    lines = []
    for name, points in _branches(result).items():
        errors = [abs(100.0 * (p.load_kpa / p.exact_kpa - 1.0)) for p in points if not math.isnan(p.exact_kpa)]
        lines.append(
            (
                name,
                str(len(points)),
                f"{min(p.load_kpa for p in points):.5g} to {max(p.load_kpa for p in points):.5g}",
                f"{max(errors):.2g}" if errors else "–",
                " ".join(dict.fromkeys(str(p.unstable) for p in points)),
                " ".join(dict.fromkeys(str(p.unstable_at_volume) for p in points)),
                ", ".join(dict.fromkeys(p.control for p in points)),
            )
        )
    header = (
        "path or branch", "states", "load, kPa", "off exact, % at most", "unstable modes on the way",
        "at held volume", "control",
    )  # fmt: skip
    return Table(header, tuple(lines), left=(0, 4, 5, 6))


def _fact_table(result: CaseResult) -> Table:
    columns: dict[str, Callable[[Fact], str]] = {
        "what": lambda f: f.quantity,
        "unit": lambda f: f.unit,
        "found": lambda f: f"{f.value:.6g}",
        "reference": lambda f: number_text(f.reference, ".6g"),
        "source": lambda f: f.source,
        "off, %": lambda f: number_text(100.0 * (f.value / (f.reference or math.nan) - 1.0), "+.4f"),
    }
    return table_of(result.facts, columns, left=(0, 1, 4))


def _draw(path: Path, result: CaseResult) -> None:
    """Draw the branches of a case: filled where they are stable, with what is known exactly."""
    series = []
    for colour, (name, points) in zip(COLOURS, _branches(result).items(), strict=False):
        x, y = _drawn(result.name, points)
        series.append(Series(x, y, {"color": colour, "linewidth": 1.0}, name))
        for stable, fill in ((True, colour), (False, "white")):
            at = [k for k, p in enumerate(points) if (p.unstable == 0) == stable]
            look = {"color": colour, "linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": fill}
            series.append(Series([x[k] for k in at], [y[k] for k in at], look))
        exact = [p.exact_kpa for p in points]
        if not all(map(math.isnan, exact)) and result.name != "blocked-bellows":
            series.append(Series(x, exact, {"color": BLACK, "linestyle": "none", "marker": "+", "markersize": 6}))
    draw_panels(path, [[Panel(series, *AXES[result.name])]], (5.6, 3.8), {**INSIDE, "fontsize": 8})


def _drawn(name: str, points: Sequence[Point]) -> tuple[list[float], list[float]]:
    """What is drawn of a case."""
    if name == "blocked-bellows":
        return [p.load_kpa for p in points], [p.force_n for p in points]
    move = [p.volume_mm3 if name == "two-spheres" else p.move for p in points]
    return move, [p.load_kpa for p in points]


def write_report(folder: Path, found: Sequence[tuple[CaseResult, dict[str, str]]]) -> Path:
    """Write rows.csv, pictures and report; one rank calls. Returns report.html."""
    write_rows(folder / "rows.csv", [r for result, _ in found for r in rows_of(result)])
    for result, _ in found:
        _draw(folder / "pictures" / f"{result.name}.png", result)
    stamps = {
        "commit": ", ".join(dict.fromkeys(stamp["commit"] for _, stamp in found)),
        "date": found[-1][1]["date"],
        "machine": provenance.machine(),
        **provenance.versions(),
    }
    content = {
        "title": TITLE,
        "cases": {
            result.name: {
                "picture": f"pictures/{result.name}.png",
                "branches": _branch_table(result),
                "facts": _fact_table(result),
                "unknowns": count(result.unknowns),
                "seconds": duration(result.seconds),
            }
            for result, _ in found
        },
        "provenance": facts_table(stamps),
    }
    return write_page(folder, "branches.md.j2", content)


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for cases and report.")
@click.option("--case", "names", multiple=True, type=click.Choice(list(CASES)), help="Only these; default all.")
def main(out: Path, names: tuple[str, ...]) -> None:
    """Follow paths through limit points and onto branches, beside what is known of them; writes rows and report."""
    comm = MPI.COMM_WORLD
    found = run_study(out, comm, names or tuple(CASES))
    if comm.rank == 0:
        click.echo(f"report: {write_report(out, [(dataclasses.replace(r), s) for r, s in found])}")


if __name__ == "__main__":
    main()
