"""The contact study: exact problems within bounds, tables from rows, the page of a small bellows."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from studies.contact.exact import PROBLEMS
from studies.contact.study import STUDY, exact_table, state_table
from studies.engine import run
from studies.models.contact import LIMIT, STIFFNESS
from studies.results.rows import REACHED, Row, read_rows, row
from studies.scene.bellows import at_pressures
from studies.scene.load import load_bellows


@pytest.fixture(scope="module")
def exact() -> list[Row]:
    return [r for problem in PROBLEMS for r in problem.rows()]


def test_exact_contact_problems_are_met(exact: list[Row]) -> None:
    compared = [r for r in exact if not math.isnan(r.error_percent)]
    assert {r.scene for r in compared} == {"tube in a rigid bore", "half a sphere in a rigid bowl", "tube in a tube"}
    for entry in (r for r in compared if r.level == f"k{STIFFNESS:g}"):  # the penalty of scenes
        # energies: the trapezoidal rule across the kink of the path is the larger part
        assert abs(entry.error_percent) < (0.2 if entry.quantity == "energy_mj" else 0.1), entry
    for entry in exact:
        if entry.quantity == "penetration_of_wall_percent":
            assert abs(entry.value) < 100.0 * LIMIT


def test_errors_fall_with_the_penalty(exact: list[Row]) -> None:
    tube = [r for r in exact if r.scene == "tube in a rigid bore"]
    gap = [abs(r.value) for r in tube if r.quantity.startswith("penetration")]
    error = [abs(r.error_percent) for r in tube if r.quantity == "contact_force_n"]
    for values in (gap, error):  # four times as stiff each
        np.testing.assert_allclose(np.divide(values[:-1], values[1:]), 4.0, rtol=0.2)
    assert len(exact_table(exact).rows) == len(exact)


def test_table_of_states_leaves_what_was_not_reached_empty() -> None:
    def entry(quantity: str, kpa: float, value: float, model: str = "axisymmetric", status: str = REACHED) -> Row:
        return row("a", quantity, "mm", kpa, model, value, "r1", status=status)

    rows = [
        entry("tip_mm", 5.0, 1.25),
        entry("min_gap_mm", 5.0, -0.001),
        entry("contact_force_n", 5.0, 2.5),
        entry("unstable_modes", 5.0, 0.0),
        entry("tip_mm", 5.0, 3.5, "axisymmetric, no contact"),
        entry("unstable_modes", 5.0, 2.0, "axisymmetric, no contact"),
        entry("tip_mm", 10.0, math.nan, status="stopped at 7.00 kPa: step size"),
    ]
    table, tip = state_table(rows, "tip_mm"), "axial displacement of the tip, mm"
    assert table.header[:3] == ("kPa", f"{tip}: level 1", f"{tip}: level 1, no contact")
    assert table.rows[0] == ("5", "1.25", "3.5", "-0.001", "2.5", "0", "2")
    assert table.rows[1] == ("10", *["–"] * 6)


def test_page_of_a_small_bellows_and_a_problem(root: Path, tmp_path: Path) -> None:
    smoke = at_pressures(load_bellows(root / "scenes" / "smoke-t2-ri5.toml"), [2.0])
    study = dataclasses.replace(STUDY, cases=lambda options: [PROBLEMS[-1], smoke])
    assert run(study, tmp_path, MPI.COMM_WORLD, {}) == 0
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "| tube in a tube | bore_mm |" in text and f"### {smoke.name}: " in text
    assert "- level 1, no contact: nothing touches" in text
    tips = {(r.model, r.level): r.value for r in read_rows(tmp_path / "rows.csv") if r.quantity == "tip_mm"}
    assert list(tips) == [("axisymmetric", "r1"), ("axisymmetric", "r2"), ("axisymmetric, no contact", "r1")]
    assert tips["axisymmetric", "r1"] == tips["axisymmetric, no contact", "r1"]
