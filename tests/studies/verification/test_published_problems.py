"""Torsion of a cylinder, Cook's membrane, the inflated ventricle, and the table that puts them beside the others."""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result
from mpi4py import MPI

from analytical.exact.flat_sheet import FlatSheet, at_pressure
from analytical.laws.of_invariants import MooneyRivlin
from studies import engine
from studies.__main__ import main
from studies.models.session import SceneResult
from studies.progress import Progress
from studies.results.exact_answers import COOK_CORNER_MM
from studies.results.rows import Row, read_rows, row
from studies.scene.load import load_scene
from studies.scene.sections import SceneError
from studies.verification import published
from studies.verification import study as verification

SCENES = Path(__file__).resolve().parents[3] / "scenes" / "exact"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


def solved(name: str, out: Path, *options: str) -> list[Row]:
    """Rows of a scene's own meshes: none finer is solved for its tolerance."""
    text = (SCENES / f"{name}.toml").read_text(encoding="utf-8")
    scene = out.with_suffix(".toml")
    scene.write_text(re.sub("tolerance_percent = .*", "tolerance_percent = 90.0", text), encoding="utf-8")
    result = run("solve", scene, "--out", out, *options)
    assert result.exit_code == 0, result.output
    return read_rows(out / "rows.csv")


def errors(rows: list[Row], quantity: str) -> list[float]:
    """Errors of a quantity, coarsest mesh first, percent."""
    return [abs(r.error_percent) for r in rows if r.quantity == quantity and math.isfinite(r.error_percent)]


@pytest.mark.parametrize(("name", "torque", "force"), [("cylinder", 0.06, 0.08), ("cylinder-tet", 0.5, 5.0)])
def test_torque_and_axial_force_of_a_twisted_cylinder(
    tmp_path, monkeypatch, name: str, torque: float, force: float
) -> None:
    levels = {"hexahedra": ("n8", "n12"), "tetrahedra": ("n8", "n12")}
    monkeypatch.setattr("studies.planning.bodies.CYLINDER_LEVELS", levels)
    rows = solved(name, tmp_path / "out")
    # measured: hexahedra 0.030 and 0.036 %, tetrahedra 0.23 and 2.8 %
    for quantity, bar in (("torque_nmm", torque), ("axial_force_n", force)):
        coarse, fine = errors(rows, quantity)
        assert fine < bar
        # energies converge with the fourth order, at least the third is asked; measured 3.2 to 4.3
        order = math.log(coarse / fine) / math.log(1.5)
        assert order > 2.7
    assert [r.value for r in rows if r.quantity == "unstable_modes"] == [0.0]


def test_cooks_membrane_tends_to_its_limit(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.COOK_LEVELS", ("n4", "n8"))
    rows = solved("cook", tmp_path / "out")
    coarse, fine = errors(rows, "corner_mm")
    assert fine < 0.2 < coarse  # measured 0.16 % with 64 cells
    assert "own" in next(r.source for r in rows if r.source)


@pytest.mark.slow
def test_reference_of_cooks_membrane_is_what_refined_meshes_tend_to(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.COOK_LEVELS", ("n24", "n48"))
    values = [r.value for r in solved("cook", tmp_path / "out") if r.quantity == "corner_mm" and r.pressure_kpa > 6e3]
    # second order, as n8 to n32 show
    assert values[1] + (values[1] - values[0]) / 3.0 == pytest.approx(COOK_CORNER_MM, abs=5e-4)


def test_tetrahedra_are_refused_for_cooks_membrane(tmp_path) -> None:
    path = tmp_path / "cook.toml"
    path.write_text((SCENES / "cook.toml").read_text(encoding="utf-8") + '[mesh]\nelement = "tet-p1"\n')
    with pytest.raises(SceneError, match="a cook is meshed in hexahedra"):
        load_scene(path)


@pytest.mark.parametrize(
    ("model", "levels"), [("axisymmetric", ("r1", "r2")), ("sector", ("n8",)), ("full3d", ("n12",))]
)
def test_apex_of_the_inflated_ventricle(tmp_path, monkeypatch, model: str, levels: tuple[str, ...]) -> None:
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", levels)
    monkeypatch.setattr("studies.planning.bodies.AROUND_LEVELS", {"hexahedra": levels, "tetrahedra": levels})
    rows = solved("ventricle", tmp_path / "out", "--model", model)
    # the groups of the benchmark differ by 0.5 %; measured 0.10, 0.38 and 0.27 %
    assert errors(rows, "apex_inside_mm")[-1] < 0.5
    assert all(r.value > 0.0 for r in rows if r.quantity == "min_det_f")


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        (
            "cylinder",
            "twist_rad_per_mm = 0.08",
            "pressure_kpa = [1.0]",
            "a cylinder is loaded by load.twist_rad_per_mm",
        ),
        ("cook", "traction_kpa", "tension_kpa", "a cook is loaded by load.traction_kpa"),
        ("ventricle", "base_mm = 5.0", "base_mm = 18.0", "must be less than inner_along_mm = 17"),
        ("ventricle", "inner_across_mm = 7.0", "inner_across_mm = 11.0", "must be less than outer_across_mm = 10"),
    ],
)
def test_wrong_scenes_are_refused(tmp_path, name: str, old: str, new: str, said: str) -> None:
    text = (SCENES / f"{name}.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / f"{name}.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(SceneError) as refusal:
        load_scene(path)
    assert said in str(refusal.value)


# --- the table ------------------------------------------------------------------------------------------------


def made(level: str, value: float, reference: float, source: str = "exact: formula") -> Row:
    return row("body", "bore_mm", "mm", 10.0, "sector", value, level, reference=reference, source=source)


def test_observed_order_of_exact_and_of_other_references() -> None:
    exact = [made(f"n{n}", 1.0 + 0.1 / n**3, 1.0) for n in (4, 8)]
    assert verification.observed_order(exact) == pytest.approx(3.0, abs=1e-9)
    # a reference that is off by far more than the meshes differ does not spoil the order
    other = [made(f"n{n}", 1.0 + 0.1 / n**2, 1.01, "published: a paper") for n in (4, 6, 10)]
    assert verification.observed_order(other) == pytest.approx(2.0, abs=1e-6)
    for rows in (exact[:1], other[:2], [made("n4", 1.001, 1.0), made("n8", 0.9999, 1.0)]):
        assert math.isnan(verification.observed_order(rows))


def test_table_holds_every_known_value_and_reuses_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.BLOCK_LEVELS", ("n2",))
    monkeypatch.setattr("studies.planning.bodies.COOK_LEVELS", ("n4", "n8", "n10"))
    chosen = ("cube", "cook", "published tube-mooney")
    scenes = [scene for scene in verification.cases({}) if scene.name in chosen]
    study = dataclasses.replace(verification.STUDY, cases=lambda options: scenes)
    for name, reuse in (("a", None), ("b", tmp_path / "a")):
        assert engine.run(study, tmp_path / name, MPI.COMM_SELF, {"reuse": reuse}) == 0
    kept = [(tmp_path / name / "cook" / "full3d-n8" / "summary.json").read_bytes() for name in "ab"]
    assert kept[0] == kept[1]  # its time too: it was not solved again
    # NaN equals nothing, so the files are compared
    assert len({(tmp_path / name / "rows.csv").read_text(encoding="utf-8") for name in "ab"}) == 1
    rows = read_rows(tmp_path / "a" / "rows.csv")
    (order,) = [r.value for r in rows if r.quantity == "corner_mm_order"]
    assert order > 1.0
    assert all(abs(r.value / r.reference - 1.0) < 1e-8 for r in rows if r.model == "exact")  # nine digits
    page = (tmp_path / "a" / "report.md").read_text(encoding="utf-8")
    assert "| cook | displacement of the corner, mm | full 3D, 10 cells along an edge |" in page
    assert "| cube | loss of stability, kPa | full 3D, 2 cells along an edge |" in page
    assert "own: limit of refined meshes" in page
    assert "torque, N mm" in page
    assert "| tube-mooney | radial displacement of the bore, mm | 1034.2 | 7.18 | 7.18243" in page
    assert "mesh" not in {scene.name for scene in verification.cases({})}


def test_a_scene_that_stopped_is_told(tmp_path) -> None:
    scene = next(scene for scene in verification.cases({}) if scene.name == "cube")
    run = SimpleNamespace(summary=SimpleNamespace(status="stopped", reason="no memory"))
    solved: list[engine.Solved[Any, Any]] = [engine.Solved(scene, SceneResult(scene, (run,), ()))]  # type: ignore[arg-type]
    assert engine.render(verification.STUDY, tmp_path, solved) == 3
    assert "- cube: no memory" in (tmp_path / "report.md").read_text(encoding="utf-8")


# ---- printed answers ---------------------------------------------------------------------------------------


HELD = {target.scene for target in published.targets() if target.held}


@pytest.mark.parametrize(
    "benchmark", [one for one in published.benchmarks() if one.scene in HELD], ids=lambda one: one.scene
)
def test_printed_answers_come_out(tmp_path: Path, benchmark: published.Benchmark) -> None:
    found = published.rows(
        published.solve(benchmark, engine.Setting(tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {}))
    )
    # the least certain target is told to 0.1 of 43 mm, the ventricle's by what groups differ, 0.5 %
    within = 0.5 if benchmark.scene == "ventricle" else 0.25
    assert len(found) == sum(target.scene == benchmark.scene for target in published.targets())
    for entry in found:
        # beside the membrane's largest pressure a thickness of 1/200 of the radius counts: 0.75 % measured
        near_maximum = benchmark.scene == "sheet-flat" and entry.pressure_kpa == 3.5
        assert abs(entry.error_percent) < (0.8 if near_maximum else within), entry


def test_a_rim_that_turns_lies_between_one_that_is_held_and_one_held_by_a_strip(tmp_path: Path) -> None:
    at = engine.Setting(tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})
    held, strip = (
        published.rows(published.solve(published.Benchmark(name), at)) for name in ("disc-mooney", "disc-pinned")
    )
    # of the shells; the manual's curve is read too high by 8 %. Measured -1.6, -1.7, -1.5 and 3.6, 3.1 %
    held = [entry for entry in held if "read off a curve" not in published.target_of(entry).obtained]
    assert len(held) == 3 and all(-2.0 < entry.error_percent < -1.0 for entry in held)
    assert len(strip) == 2 and all(2.0 < entry.error_percent < 5.0 for entry in strip)


def test_targets_of_the_flat_sheet_and_of_the_second_rise() -> None:
    sheet, law = FlatSheet(50.0, 0.25), MooneyRivlin((0.1713, 0.0047, 0.0, 0.0, 0.0))
    of_sheet = [t for t in published.targets() if t.scene == "sheet-flat"]
    assert len(of_sheet) == 4
    for target in of_sheet:
        state = at_pressure(sheet, law, 1e-3 * target.pressure_kpa)
        thinned = 0.5 * sheet.thickness_mm * (1.0 - state.pole_stretch**-2)
        assert target.target == pytest.approx(state.height_mm + thinned, abs=1e-4)  # its last digit
    (rise,) = [t for t in published.targets() if t.scene == "balloon-mooney" and t.quantity == "bore_mm"]
    stretch = (9.95 + rise.target) / 10.0  # the bore starts at 9.95 mm; so thin then, its radius is the middle's
    pressure = 4.0 * 0.01 * (150.0 + 15.0 * stretch**2) * (1.0 / stretch - stretch**-7)
    assert pressure == pytest.approx(rise.pressure_kpa, rel=1e-5)


def test_a_target_without_an_answer_is_told() -> None:
    (target,) = [one for one in published.targets() if one.scene == "tube-mooney"]
    stopped = SimpleNamespace(scene=SimpleNamespace(name="tube-mooney"), rows=(), reason="stopped at 3 kPa")
    (entry,) = published.rows(stopped)  # type: ignore[arg-type]
    assert math.isnan(entry.value) and entry.status == "stopped at 3 kPa" and entry.reference == target.target
    assert "stopped at 3 kPa" in str(published.table([entry]).rows)
    assert published.bar([entry]).missed
    off = [dataclasses.replace(entry, error_percent=percent) for percent in (-0.5, 1.5)]
    assert published.bar(off).missed and not published.bar(off[:1]).missed and not published.bar([]).missed


def test_a_bulge_begins_at_the_maximum_of_a_long_tube(tmp_path: Path) -> None:
    at = engine.Setting(tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})
    published.solve(published.Benchmark("tube-bulge"), at)
    with (tmp_path / published.KEPT / "tube-bulge" / "axisymmetric-r4" / "path.csv").open(encoding="utf-8") as file:
        states = list(csv.DictReader(file))
    rising, beyond = states[-2:]
    assert rising["unstable_modes"] == "0" and float(rising["pressure_kpa"]) > 0.9999 * 5.40332
    # half a percent past the maximum: the fall of the pressure itself, and waves along the axis at held volume
    assert float(beyond["pressure_kpa"]) > 0.99 * 5.40332 and int(beyond["unstable_modes"]) > 1
