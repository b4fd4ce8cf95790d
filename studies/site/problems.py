"""A sheet per verification problem: what is solved, what is known, what comes out, from the kept rows of docs/exact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from studies.report.labels import quantity_label, run_label
from studies.results.provenance import ROOT
from studies.results.rows import Row
from studies.scene.load import kept_scene
from studies.site.markdown import cell, table
from studies.site.values import DOCS, rows_of

SCENES, PUBLISHED = ROOT / "scenes" / "exact", ROOT / "scenes" / "published"
_HEADER = ("quantity", "model and mesh", "load, kPa", "value", "±", "reference", "error, %")


def sheets() -> Iterator[tuple[str, str]]:
    """Names and Markdown of all sheets."""
    of_scene: dict[str, list[Row]] = {}
    for row in rows_of("exact"):
        of_scene.setdefault(row.scene, []).append(row)
    for path in sorted(SCENES.glob("*.toml")):
        if path.stem in of_scene:
            yield path.stem, sheet(path, of_scene[path.stem])
    for path in sorted(PUBLISHED.glob("*.toml")):
        if printed := [row for row in rows_of("verification") if row.scene == path.stem]:
            yield path.stem, sheet(path, printed)


def sheet(path: Path, rows: Sequence[Row]) -> str:
    """Markdown of the sheet of a scene."""
    name, folder = path.stem, path.parent.name
    exact = folder == SCENES.name
    text = path.read_text(encoding="utf-8")
    about = " ".join(line.lstrip("# ") for line in text.partition("name =")[0].splitlines())
    sources = sorted({row.source for row in rows if row.source})
    parts = [
        f"# {kept_scene(path).title}",
        about,
        "**What is known:** " + ("; ".join(sources) or "nothing exactly: meshes are compared with each other") + ".",
        *_picture(name),
        "## Result",
        table(_HEADER, map(_line, rows)),
        *(_orders([row for row in rows_of("verification") if row.scene == name]) if exact else ()),
        "## The scene",
        f"```toml\n{text.rstrip()}\n```",
        f"Run it: `.venv/bin/bellowsx solve scenes/{folder}/{name}.toml --out results/{name}`."
        + (" All problems: `make study-exact`, [report](../exact/report.md);" if exact else "")
        + " Table of all: `make study-verification`, [verification](../verification/report.md).",
    ]
    return "\n\n".join(parts) + "\n"


def _picture(name: str) -> Iterator[str]:
    if (DOCS / "exact" / "pictures" / f"{name}.png").exists():
        yield f"![Computed values of {name} beside the known ones, over the load](../exact/pictures/{name}.png)"


def _line(row: Row) -> list[str]:
    numbers = (row.pressure_kpa, row.value, row.uncertainty, row.reference, row.error_percent)
    load, value, doubt, reference, error = ("–" if number != number else f"{number:.6g}" for number in numbers)
    return [cell(quantity_label(row.quantity)), run_label(row.model, row.level), load, value, doubt, reference, error]


def _orders(rows: Sequence[Row]) -> Iterator[str]:
    """Observed orders of convergence."""
    found = [row for row in rows if row.quantity.endswith("_order") and row.value == row.value]
    if found:
        lines = [
            (quantity_label(row.quantity.removesuffix("_order")), run_label(row.model, row.level), f"{row.value:.2f}")
            for row in found
        ]
        yield "## Observed orders of convergence"
        yield table(("quantity", "model and finest mesh", "order"), lines)
