"""Pressures beyond a limit point through the command line: on the farther branch, said so, or refused with numbers."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from studies.__main__ import main
from studies.results.rows import Row, read_rows
from studies.results.run_files import read_path, read_summary

SPHERE = 'kind = "sphere"\ninner_radius_mm = 9.5\nouter_radius_mm = 10.5'
THICK = 'kind = "sphere"\ninner_radius_mm = 5.0\nouter_radius_mm = 10.0'
CAPPED = 'kind = "tube"\ninner_radius_mm = 9.5\nouter_radius_mm = 10.5\nlength_mm = 5.0\nends = "capped"'
ALEXANDER = 'law = "yeoh"\nc_kpa = [312.37237, 0.54257, 0.06962]'
SOFT = 'law = "yeoh"\nc_kpa = [100.0, 0.5, 0.02]'
NEO_HOOKE = 'law = "neo-hooke"\nmu_kpa = 400.0'


@pytest.fixture
def solve(tmp_path: Path, monkeypatch):
    """Solve a scene on one mesh; the command's result and the folder."""
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", ("r1",))

    def run(geometry: str, material: str, load: str, quantities: str = '"bore_mm"') -> tuple[Result, Path]:
        scene, out = tmp_path / "far.toml", tmp_path / "out"
        scene.write_text(
            f'name = "far"\n[geometry]\n{geometry}\n[material]\n{material}\n[load]\n{load}\n[ask]\n'
            f"quantities = [{quantities}]\n",
            encoding="utf-8",
        )
        return CliRunner().invoke(main, ["solve", str(scene), "--out", str(out)]), out

    return run


def bores(out: Path) -> list[Row]:
    return [row for row in read_rows(out / "rows.csv") if row.quantity == "bore_mm"]


@pytest.mark.parametrize("control", ["auto", "arc"])
def test_pressures_above_the_limit_point_are_met_on_the_farther_branch(solve, control: str) -> None:
    load = f'pressure_kpa = [50.0, 85.5579021, 116.669866]\ncontrol = "{control}"'
    result, out = solve(SPHERE, ALEXANDER, load)
    assert result.exit_code == 0, result.output
    near, *far = bores(out)
    assert near.status == "reached"
    assert [row.value for row in far] == pytest.approx([48.20, 56.93], abs=0.005)
    for row in far:
        assert row.status == "reached, after a snap at 77.78 kPa"
        assert abs(row.error_percent) < 1e-3
        assert row.source == "exact: sphere beyond its limit point"
    assert result.output.count("after a snap at 77.78 kPa") == 2
    path = read_path(out)
    assert [row.unstable_modes for row in path if row.status == "requested"] == [0.0, 0.0, 0.0]
    # rows of the path say where it has passed the limit point, and between the branches they are unstable
    assert math.isnan(path[0].limit_kpa)
    assert path[-1].limit_kpa == pytest.approx(77.77991, rel=1e-5)
    assert max(row.unstable_modes for row in path) == 1.0


@pytest.mark.parametrize(
    ("geometry", "asked", "limit"),
    [(THICK, "[50.0, 200.0]", 166.1), (CAPPED, "[5.0, 20.0, 30.0]", 15.20)],
    ids=["thick sphere", "capped tube"],
)
def test_other_balloons_snap_too(solve, geometry: str, asked: str, limit: float) -> None:
    result, out = solve(geometry, SOFT, f"pressure_kpa = {asked}")
    assert result.exit_code == 0, result.output
    found = bores(out)
    assert found[0].status == "reached"
    assert all(row.status == f"reached, after a snap at {limit:.4g} kPa" for row in found[1:])
    # the coarsest mesh: 0.2 % off where the wall of the thick sphere has become thin
    assert all(abs(row.error_percent) < 0.3 for row in found)


def test_no_farther_branch_is_promised_where_there_is_none(solve) -> None:
    result, out = solve(SPHERE, NEO_HOOKE, "pressure_kpa = [30.0, 80.0]")
    assert result.exit_code == 3
    reason = read_summary(out).reason
    assert "limit point at 49.56" in reason
    assert "nor does the pressure rise again" in reason
    assert "branch" not in reason and "largest_volume" not in reason
    near, far = bores(out)
    assert abs(near.error_percent) < 1e-4
    assert math.isnan(far.value)
    assert math.isnan(far.reference)
    assert far.status.startswith("stopped at 49.56")


def test_a_path_cut_short_names_the_key_that_follows_it(solve) -> None:
    result, out = solve(SPHERE, ALEXANDER, "pressure_kpa = [50.0, 85.5579021]\nlargest_volume = 150")
    assert result.exit_code == 3
    reason = read_summary(out).reason
    assert "limit point at 77.7799 kPa" in reason
    assert "a farther branch begins, which load.largest_volume above 150 follows" in reason


def test_pressure_control_stays_before_the_limit_point(solve) -> None:
    result, out = solve(SPHERE, ALEXANDER, 'pressure_kpa = [50.0, 85.5579021]\ncontrol = "pressure"')
    assert result.exit_code == 3
    assert "pressure control cannot pass it" in read_summary(out).reason
    assert all(math.isnan(row.limit_kpa) for row in read_path(out))


def test_a_limit_point_is_found_beside_pressures_beyond_it(solve) -> None:
    result, out = solve(SPHERE, ALEXANDER, "pressure_kpa = [50.0, 85.5579021]", '"bore_mm", "limit_kpa"')
    assert result.exit_code == 0, result.output
    limit = next(row for row in read_rows(out / "rows.csv") if row.quantity == "limit_kpa")
    assert abs(limit.error_percent) < 1e-3
    assert bores(out)[-1].value == pytest.approx(48.20, abs=0.005)


@pytest.mark.parametrize("value", ["1.0", "0", "-3", "nan", "inf"])
def test_a_largest_volume_that_cannot_be_is_refused(solve, value: str) -> None:
    result, out = solve(SPHERE, NEO_HOOKE, f"pressure_kpa = [30.0]\nlargest_volume = {value}")
    assert result.exit_code == 2
    assert "load.largest_volume" in result.output
    assert not out.exists()


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        (77.7, "reached"),
        (77.77, "reached"),
        (77.7801, "reached, after a snap at 77.78 kPa"),
    ],
)
def test_just_below_the_limit_point_the_state_is_the_near_one(solve, asked: float, status: str) -> None:
    result, out = solve(SPHERE, ALEXANDER, f"pressure_kpa = [{asked}]")
    assert result.exit_code == 0, result.output
    (row,) = bores(out)
    assert row.status == status
    assert abs(row.error_percent) < 0.01


def test_two_hundred_pressures(solve) -> None:
    asked = [0.25 * k for k in range(1, 201)]
    result, out = solve(SPHERE, ALEXANDER, f"pressure_kpa = {asked}")
    assert result.exit_code == 0, result.output
    found = bores(out)
    assert [row.pressure_kpa for row in found] == asked
    assert all(row.status == "reached" and abs(row.error_percent) < 1e-4 for row in found)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("[20.0, 10.0]", "must ascend strictly"),
        ("[10.0, 10.0]", "must ascend strictly"),
        ("[0.0, 10.0]", "must be greater than 0"),
        ("[-5.0, 10.0]", "must be greater than 0"),
        ("[10.0, 10.00001]", "by more than 1e-05 of each"),
        ("[1e-9, 10.0]", "load.pressure_kpa = 1e-09: less than a millionth of the initial shear modulus"),
    ],
)
def test_pressures_that_cannot_be_are_refused(solve, asked: str, said: str) -> None:
    result, out = solve(SPHERE, NEO_HOOKE, f"pressure_kpa = {asked}")
    assert result.exit_code == 2
    assert said in result.output
    assert not out.exists()
