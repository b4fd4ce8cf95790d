"""Files of a run: names that keep loads apart, damaged ones that are no answer."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from solvers.contact.pairs import PairReport
from solvers.state import State
from studies.models.contact import read_reports, write_reports
from studies.results.run_files import PathRow, field_file, load_state, read_path, save_state, write_path

BLANK = State(np.zeros((3, 2)), np.zeros(3), np.zeros((0, 0)), 0.0)
ROW = PathRow(
    1.0, "volume", 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.9, math.nan, 0.0, "", 4, 1.0, "requested", 0.01, residual=2e-9
)


def test_states_at_close_and_at_small_loads_are_kept_apart(tmp_path: Path) -> None:
    loads_kpa = [1e-6, 2e-6, 3e-5, 20.0, 20.0003, 20.00031, 1234.5, 1234.52]
    for number, load in enumerate(loads_kpa):
        state = dataclasses.replace(BLANK, displacement_mm=np.full((3, 2), number), load_mpa=1e-3 * load)
        save_state(tmp_path, "x", state, dataclasses.replace(ROW, pressure_kpa=load))
    for number, load in enumerate(loads_kpa):
        found = load_state(tmp_path, "x", 1e-3 * load)
        assert found is not None and found[1].pressure_kpa == load
        assert (found[0].displacement_mm == number).all()
    assert len({field_file(tmp_path, 1e-3 * load) for load in loads_kpa}) == len(loads_kpa)
    # the names of round loads are those of always
    assert field_file(tmp_path, -5e-3).name == "p05.000.vtu" and (tmp_path / "states" / "p0020.0000.npz").exists()


@pytest.mark.parametrize("length", [0, 1, 100])
def test_damaged_state_is_none(tmp_path: Path, length: int) -> None:
    save_state(tmp_path, "x", BLANK, ROW)
    (file,) = (tmp_path / "states").iterdir()
    file.write_bytes(file.read_bytes()[:length])
    assert load_state(tmp_path, "x", 0.0) is None


def test_contact_at_close_loads_is_kept_apart(tmp_path: Path) -> None:
    loads_kpa = [14.0, 14.0001, 14.00003]
    for load in loads_kpa + loads_kpa[:1]:
        write_reports(tmp_path / "contact.csv", load, (PairReport("rings", -0.01, load, 1),))
    found = {float(row["pressure_kpa"]): float(row["force_n"]) for row in read_reports(tmp_path / "contact.csv")}
    assert found == dict(zip(loads_kpa, loads_kpa, strict=True))


def test_residual_of_each_state_is_in_the_table(tmp_path: Path) -> None:
    write_path(tmp_path, [ROW, dataclasses.replace(ROW, residual=3e-6)])  # the second had stalled
    assert [row.residual for row in read_path(tmp_path)] == [2e-9, 3e-6]
