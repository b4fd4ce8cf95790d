"""The studies of contact and vacuum: exact problems within bounds, tables from rows, a report of a small bellows."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from studies.contact.exact import exact_rows
from studies.contact.study import exact_table, state_table
from studies.models.contact import LIMIT, STIFFNESS
from studies.progress import Progress
from studies.results.rows import REACHED, Row, read_rows, row
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows
from studies.vacuum import study as vacuum_study


@pytest.fixture(scope="module")
def exact() -> list[Row]:
    return exact_rows()


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
        entry("tip_mm", 10.0, math.nan, status="stopped at 7.00 kPa: step size"),
    ]
    table = state_table(rows, "tip_mm")
    assert table.header[:3] == ("kPa", "tip, mm: r1", "tip, mm: r1, no contact")
    assert table.rows[0] == ("5", "1.25", "3.5", "-0.001", "2.5", "0", "")
    assert table.rows[1] == ("10", "", "", "", "", "", "")


def test_vacuum_report_of_a_small_bellows(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    smoke = load_bellows(root / "scenes" / "smoke-t2-ri5.toml")
    load = smoke.load.model_copy(update={"pressure_kpa": [-0.5, -2.0]})
    scene: BellowsScene = smoke.model_copy(update={"load": load})
    monkeypatch.setattr(vacuum_study, "scenes", lambda: [scene])
    page, reached = vacuum_study.write_study(tmp_path, (1,), Progress(MPI.COMM_WORLD))
    assert reached
    text = page.with_suffix(".md").read_text(encoding="utf-8")
    assert "| -2 |" in text and "contact modelled beyond" in text
    for picture in ("contractions", scene.name):
        assert (tmp_path / "pictures" / f"{picture}.png").stat().st_size > 5000
    tips = [r.value for r in read_rows(tmp_path / "rows.csv") if r.quantity == "tip_mm"]
    assert len(tips) == 2 and tips[1] < tips[0] < 0.0


def test_scenes_under_vacuum_are_sound() -> None:
    scenes = vacuum_study.scenes()
    assert len(scenes) == 6
    assert all(scene.load.sense < 0.0 and scene.contact.model == "auto" for scene in scenes)
