"""Published benchmarks: what a paper or manual prints as the answer, beside what `bellowsx solve` gives.

The targets are lines of ``scenes/published/targets.csv``, each with its source and how the printed number was obtained;
their scenes are beside it, or among those with exact answers. Each is solved as a user would, by the cheapest model
that keeps the scene's tolerance.
"""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from studies.engine import Bar, Setting
from studies.models.session import SceneResult, run_plan
from studies.planning.planner import make_plan
from studies.report.labels import quantity_label, run_label
from studies.report.numbers import number_text
from studies.report.tables import Table, table_of
from studies.results import provenance
from studies.results.rows import Row, row
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene

FOLDERS: Final = tuple(provenance.ROOT / "scenes" / name for name in ("published", "exact"))
# Where their runs are kept, within the study's folder.
KEPT: Final = "published"
# What a result may differ from the printed number by: several are read off other programs' or groups' results.
WITHIN_PERCENT: Final = 1.0


@dataclass(frozen=True)
class Target:
    """A printed answer.

    Attributes
    ----------
    scene, quantity
        Of the scene that is solved.
    pressure_kpa
        Load of the value, kPa; NaN where it is one of a whole path.
    target
        The printed number, in the quantity's unit.
    source, obtained
        Where it is printed, and how that number was obtained.
    held
        False where the number is less certain than the bar, or of a problem that is not quite the scene's, as
        ``obtained`` says: the ratio is told, and held to nothing.
    """

    scene: str
    quantity: str
    pressure_kpa: float
    target: float
    source: str
    obtained: str
    held: bool


@dataclass(frozen=True)
class Benchmark:
    """A scene with printed answers, as a case of the study."""

    scene: str

    @property
    def name(self) -> str:
        """Its name among the cases, of which another may be of the same scene."""
        return f"published {self.scene}"


def benchmarks() -> list[Benchmark]:
    """The scenes of the table."""
    return [Benchmark(name) for name in dict.fromkeys(target.scene for target in targets())]


@functools.cache
def targets() -> tuple[Target, ...]:
    """The lines of the table."""
    with (FOLDERS[0] / "targets.csv").open(encoding="utf-8", newline="") as file:
        return tuple(
            Target(
                line["scene"],
                line["quantity"],
                float(line["pressure_kpa"] or math.nan),
                float(line["target"]),
                line["source"],
                line["obtained"],
                {"yes": True, "no": False}[line["held"]],
            )
            for line in csv.DictReader(file)
        )


def solve(case: Benchmark, at: Setting) -> SceneResult[BodyScene]:
    """Solve a scene of the table."""
    path = next(folder / f"{case.scene}.toml" for folder in FOLDERS if (folder / f"{case.scene}.toml").exists())
    scene = load_scene(path)
    assert isinstance(scene, BodyScene)
    return run_plan(
        scene, path.read_text(encoding="utf-8"), make_plan(scene), at.out / KEPT / case.scene, at.comm, at.progress
    )


def rows(result: SceneResult[BodyScene]) -> list[Row]:
    """The answer's rows beside the targets of its scene; without a value where it has none."""
    found = []
    for target in targets():
        if target.scene != result.scene.name:
            continue
        mine = [
            r for r in result.rows if r.quantity == target.quantity and _same_load(r.pressure_kpa, target.pressure_kpa)
        ]
        if not mine:
            unit = target.quantity.rpartition("_")[2]
            mine = [
                row(
                    target.scene,
                    target.quantity,
                    unit,
                    target.pressure_kpa,
                    "",
                    math.nan,
                    status=result.reason or "no row",
                )
            ]
        last = mine[-1]  # the finest mesh, or what the meshes lead to
        beside = row(
            *(
                last.scene,
                last.quantity,
                last.unit,
                last.pressure_kpa,
                last.model,
                last.value,
                last.level,
                last.uncertainty,
            ),
            target.target,
            f"published: {target.source}",
        )
        found.append(replace(beside, status=last.status))
    return found


def bar(found: Sequence[Row]) -> Bar:
    """That every printed number comes out which is certain enough, and of the scene's own problem."""
    off = [abs(r.error_percent) for r in found if target_of(r).held]
    met = all(percent <= WITHIN_PERCENT for percent in off) if off else None  # one without a result is NaN
    told = f"{len(off)} numbers, at most {max(off):.2g} % off" if off else "none solved"
    if others := len(found) - len(off):
        told += f"; {others} read off a curve or with another rim are not held to it"
    return Bar(f"published answers within {WITHIN_PERCENT:g} %", told, met)


def target_of(entry: Row) -> Target:
    """The target that a row of `rows` is beside."""
    return next(
        t
        for t in targets()
        if (t.scene, t.quantity, f"published: {t.source}") == (entry.scene, entry.quantity, entry.source)
        and _same_load(entry.pressure_kpa, t.pressure_kpa)
    )


def _same_load(one: float, other: float) -> bool:
    return math.isnan(other) or math.isclose(one, other, rel_tol=1e-6)


def table(found: Sequence[Row]) -> Table:
    """Problem, quantity, load, printed number, result, ratio, source, and how the printed number was obtained."""
    columns = {
        "problem": lambda r: r.scene,
        "quantity": lambda r: quantity_label(r.quantity),
        "load, kPa": lambda r: number_text(r.pressure_kpa, ".5g"),
        "printed": lambda r: f"{r.reference:.6g}",
        "result": lambda r: r.status if math.isnan(r.value) else f"{r.value:.6g}" + _band(r),
        "model and mesh": lambda r: run_label(r.model, r.level) if r.model else "",
        "result / printed": lambda r: number_text(r.value / r.reference, ".5f"),
        "source": lambda r: r.source.removeprefix("published: "),
        "how the printed number was obtained": lambda r: target_of(r).obtained,
    }
    return table_of(found, columns, left=(0, 1, 5, 7, 8))


def _band(entry: Row) -> str:
    return "" if math.isnan(entry.uncertainty) else f" ± {entry.uncertainty:.1g}"
