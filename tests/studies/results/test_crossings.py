"""Where stability is lost, told by several meshes: what one of them contradicts is not certain."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from studies.results.body_rows import body_rows
from studies.results.rows import Row
from studies.results.run_files import PathRow
from studies.results.runs import MERIDIAN_ORDERS, Run, tip_convergence
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene

NAN = math.nan


def run_of(level: str, crossing_kpa: float, highest_kpa: float = 0.5) -> Run:
    state = PathRow(highest_kpa, "", NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, "", 0, 0.0, "requested", NAN)
    facts = {"kind": "bifurcation", "pressure_kpa": crossing_kpa, "within_kpa": 1e-6, "modes_before": 0}
    crossing = {} if math.isnan(crossing_kpa) else {**facts, "modes_after": 1}
    summary: Any = SimpleNamespace(
        model="sector", level=level, crossing=crossing, status="reached", reason="", plan=(), dofs=1
    )
    return Run(summary, (state,))


def crossing(root: Path, *runs: Run) -> Row:
    scene = load_scene(root / "scenes" / "exact" / "ring-2.toml")
    assert isinstance(scene, BodyScene)
    asked = scene.model_copy(update={"ask": scene.ask.model_copy(update={"quantities": ["crossing_kpa"]})})
    return next(row for row in reversed(body_rows(asked, runs)) if row.quantity == "crossing_kpa")


def test_meshes_that_agree_are_certain(root: Path) -> None:
    assert crossing(root, run_of("r1", 0.21), run_of("r2", 0.2)).uncertainty < 0.1


def test_a_crossing_that_coarser_meshes_went_past_is_as_uncertain_as_they_went_far(root: Path) -> None:
    found = crossing(root, run_of("r1", NAN), run_of("r2", NAN), run_of("r4", 0.2))
    assert found.value == 0.2
    assert not found.uncertainty < 0.3 * (1.0 - 1e-12)


def test_a_crossing_that_one_of_two_meshes_reached_alone_is_not_certain(root: Path) -> None:
    found = crossing(root, run_of("r1", NAN, highest_kpa=0.1), run_of("r2", 0.2))
    assert math.isnan(found.uncertainty)


@pytest.mark.parametrize("level", ["r1", "r2"])
def test_none_is_told_with_how_far_it_was_looked_for(root: Path, level: str) -> None:
    assert crossing(root, run_of(level, NAN)).status == "none up to 0.5 kPa"


def test_states_of_other_stability_lead_to_no_limit() -> None:
    def run_at(level: str, tip_mm: float, modes: int) -> Run:
        state = PathRow(1.0, "", tip_mm, NAN, 0.0, NAN, NAN, NAN, NAN, NAN, modes, "", 0, 0.0, "requested", NAN)
        return Run(SimpleNamespace(model="axisymmetric", level=level), (state,))  # type: ignore[arg-type]

    tips = (("r1", 20.1258), ("r2", 20.0969), ("r4", 20.0863))
    alike = tip_convergence([run_at(*tip, 0) for tip in tips], 1.0, MERIDIAN_ORDERS)
    assert alike.of_limit < 0.02
    # the finest mesh sees a crease; quadrilaterals and triangles then differed by five times their uncertainties
    runs = [run_at(*tip, int(tip[0] == "r4")) for tip in tips]
    other = tip_convergence(runs, 1.0, MERIDIAN_ORDERS)
    assert math.isnan(other.of_limit)
    assert other.uncertainty(20.0863) >= 3.0 * (20.1258 - 20.0863) * (1.0 - 1e-12)
