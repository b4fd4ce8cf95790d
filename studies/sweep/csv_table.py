"""The table of a sweep: a row per scene and pressure, with the swept keys, the closed forms and the finite elements."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, get_args

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsError
from studies.models.tolerance import marked, shortfalls
from studies.planning.levels import LIMIT
from studies.results.bellows_rows import bellows_rows
from studies.results.csv_files import field_text, field_value, read_lines, write_lines
from studies.results.rows import NOT_MET, REACHED, Row, difference_percent, row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, dimensions_of
from studies.scene.materials import law_of
from studies.scene.sweep import Variant

Chain = Literal["closed_form", "closed_form_balanced", "closed_form_seat"]
CHAINS: tuple[Chain, ...] = get_args(Chain)
REFUSED, FAILED = "refused: ", "failed: "


@dataclass(frozen=True)
class SweepRow:
    """What is known of a scene at a pressure; NaN (an empty field) where there is no number.

    Attributes
    ----------
    scene
        Its name and the name of its folder.
    values
        The swept keys' values; None where the scene leaves a key to its default.
    pressure_kpa
        Cavity pressure; NaN for a refused scene, which has one row.
    quantity, unit
        ``tip_mm``, or ``tip_force_n`` of a blocked tip, and its unit.
    closed_form, closed_form_balanced, closed_form_seat
        The corrected chain, the balanced one, and the corrected one with the free half pitch.
    unfolding_kpa
        Pressure at which the closed form is fully unfolded.
    axisymmetric, uncertainty, level
        The axisymmetric answer, its discretisation uncertainty in the same unit, and the finest mesh that it is of, or
        that it is extrapolated.
    unstable_modes
        Number of the axisymmetric model's unstable modes.
    closed_form_percent, closed_form_balanced_percent, closed_form_seat_percent
        Difference of each closed form from the axisymmetric answer, % of the latter.
    status
        ``reached``, ``tolerance not met: …`` (reached, but not as certain), ``stopped at … kPa: why``,
        ``failed: why``, ``refused: why`` or ``not run yet``.
    """

    scene: str
    values: Mapping[str, Any]
    pressure_kpa: float
    quantity: str = ""
    unit: str = ""
    closed_form: float = math.nan
    closed_form_balanced: float = math.nan
    closed_form_seat: float = math.nan
    unfolding_kpa: float = math.nan
    axisymmetric: float = math.nan
    uncertainty: float = math.nan
    level: str = ""
    unstable_modes: float = math.nan
    closed_form_percent: float = math.nan
    closed_form_balanced_percent: float = math.nan
    closed_form_seat_percent: float = math.nan
    status: str = REACHED

    @property
    def reached(self) -> bool:
        """True if there is an answer, however certain."""
        return self.status.startswith((REACHED, NOT_MET))

    def chain(self, chain: Chain) -> float:
        """The answer of a closed form."""
        return float(getattr(self, chain))

    def percent(self, chain: Chain) -> float:
        """How far it is from the axisymmetric answer, %."""
        return float(getattr(self, f"{chain}_percent"))


_PLAIN = {f.name: f.type for f in fields(SweepRow) if f.name not in ("scene", "values")}


def refused_rows(variant: Variant) -> tuple[SweepRow, ...]:
    """The row of a scene that cannot be built."""
    return (SweepRow(variant.name, variant.values, math.nan, status=REFUSED + variant.refusal),)


def solved_rows(variant: Variant, scene: BellowsScene, runs: Sequence[Run], fault: str = "") -> tuple[SweepRow, ...]:
    """A row per requested pressure, from a scene's axisymmetric runs, coarsest first; of none, with why it failed."""
    quantity = scene.main_quantity
    level = runs[-1].summary.level if runs else ""
    rows: Sequence[Row] = bellows_rows(scene, runs)
    rows = marked(rows, shortfalls(scene, rows, "axisymmetric", level))
    unfolding = _unfolding_kpa(scene)
    found = []
    for pressure in scene.load.pressure_kpa:
        here = [r for r in rows if r.pressure_kpa == pressure]
        values = {r.model: r for r in here if r.quantity == quantity and r.level in ("", level, LIMIT)}
        tip = values.get("axisymmetric", row(scene.name, quantity, "", pressure, "axisymmetric", math.nan))
        chains = {chain: values[chain].value if chain in values else math.nan for chain in CHAINS}
        found.append(
            SweepRow(
                scene=variant.name,
                values=variant.values,
                pressure_kpa=pressure,
                quantity=quantity,
                unit="N" if quantity == "tip_force_n" else "mm",
                **{str(chain): value for chain, value in chains.items()},
                unfolding_kpa=unfolding,
                axisymmetric=tip.value,
                uncertainty=tip.uncertainty,
                level=tip.level or level,
                unstable_modes=next((r.value for r in here if r.quantity == "unstable_modes"), math.nan),
                **{f"{chain}_percent": difference_percent(value, tip.value) for chain, value in chains.items()},
                status=FAILED + fault if fault else tip.status,
            )
        )
    return tuple(found)


def _unfolding_kpa(scene: BellowsScene) -> float:
    try:
        path = closed_form(dimensions_of(scene), law_of(scene.material), scene.load.pressure_kpa)
    except BellowsError:
        return math.nan
    return float(path.unfolding_pressure_kpa[0])


def comparison_rows(entry: SweepRow) -> list[Row]:
    """The finite elements' row, and those of the closed forms against it."""
    at = (entry.scene, entry.quantity or "tip_mm", entry.unit or "mm", entry.pressure_kpa)
    rows = [row(*at, "axisymmetric", entry.axisymmetric, entry.level, entry.uncertainty, status=entry.status)]
    if entry.quantity:
        against = (entry.axisymmetric, f"axisymmetric {entry.level}" if entry.level else "")
        rows += [row(*at, chain, entry.chain(chain), "", math.nan, *against) for chain in CHAINS]
    return rows


# --- the file -------------------------------------------------------------------------------


def write_table(path: Path, rows: Sequence[SweepRow]) -> None:
    """Write sweep.csv: the scene, the swept keys, then the fields of `SweepRow`; numbers with nine digits."""
    lines = (
        [entry.scene, *map(value_text, entry.values.values()), *(field_text(getattr(entry, n), 9) for n in _PLAIN)]
        for entry in rows
    )
    write_lines(path, ["scene", *rows[0].values, *_PLAIN], lines)


def read_table(path: Path) -> list[SweepRow]:
    """Read what `write_table` has written."""
    found = []
    for line in read_lines(path):
        scene = line.pop("scene")
        plain = {name: field_value(kind, line.pop(name)) for name, kind in _PLAIN.items()}
        found.append(SweepRow(scene, {key: _value(text) for key, text in line.items()}, **plain))
    return found


def value_text(value: Any) -> str:
    """A key's value as one field: text as it is, lists and tables as JSON, None empty."""
    if value is None or isinstance(value, str):
        return value or ""
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)


def _value(text: str) -> Any:
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text
