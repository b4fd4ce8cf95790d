"""A tolerance that is not met: finer meshes first, then a sentence, the rows' status and exit code 3."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mpi4py import MPI

from studies.__main__ import main
from studies.models.session import run_all_models
from studies.planning import bodies
from studies.planning.levels import MOST_UNKNOWNS
from studies.progress import Progress
from studies.results.rows import NOT_MET, REACHED, Row, read_rows
from studies.results.run_files import read_summary
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene
from studies.sweep.csv_table import read_table

ROOT = Path(__file__).resolve().parents[3]
EXACT = ROOT / "scenes" / "exact"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture
def scene(tmp_path: Path):
    """Path of a shipped scene that asks for a tolerance, with texts replaced, (old, new) each."""

    def make(name: str, tolerance: float, *changes: tuple[str, str]) -> Path:
        text = (ROOT / "scenes" / f"{name}.toml").read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        text = re.sub(r"tolerance_percent = [\d.]+", "", text)
        path = tmp_path / Path(name).with_suffix(".toml").name
        shutil.copy(EXACT / "octant.msh", tmp_path)
        path.write_text(text.replace("[ask]", f"[ask]\ntolerance_percent = {tolerance:.12f}"), encoding="utf-8")
        return path

    return make


@pytest.fixture
def no_finer(monkeypatch: pytest.MonkeyPatch) -> None:
    """No mesh beyond those of the plan."""
    for model in MOST_UNKNOWNS:
        monkeypatch.setitem(MOST_UNKNOWNS, model, 0)


def finest(rows: list[Row], quantity: str) -> list[Row]:
    of = [r for r in rows if r.quantity == quantity and r.model != "closed_form"]
    return [r for r in of if (r.model, r.level) == (of[-1].model, of[-1].level)]


def said(result: Result) -> str:
    """The sentence on the tolerance, which is told once and as an error."""
    assert result.exit_code == 3, result.output
    (sentence,) = [line for line in result.stderr.splitlines() if "not met" in line]
    assert "not met" not in result.stdout
    return sentence


def reached_percent(sentence: str) -> float:
    (number,) = re.findall(r"± (\S+) % reached", sentence)
    return float(number)


# --- a simple body ------------------------------------------------------------------------------------------


def test_finer_meshes_are_solved_until_the_tolerance_is_met(scene, tmp_path) -> None:
    out = tmp_path / "out"
    result = run("solve", scene("exact/tube", 1e-6), "--out", out)
    assert result.exit_code == 0, result.output
    # r4 is certain within 1e-5 %, of order 4
    assert (out / "axisymmetric-r8").exists() and not (out / "axisymmetric-r16").exists()
    assert "tolerance 1e-06 %: met, axisymmetric, level 8" in result.stdout
    assert read_summary(out).status == REACHED
    for row in finest(read_rows(out / "rows.csv"), "bore_mm"):
        assert row.status == REACHED
        assert row.uncertainty <= 1e-8 * row.value
        assert row.value == pytest.approx(row.reference, rel=2e-8)  # rows have nine digits


def test_what_was_reached_and_what_to_do_is_said_and_the_remedy_works(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(MOST_UNKNOWNS, "axisymmetric", 500)
    out = tmp_path / "out"
    sentence = said(run("solve", scene("exact/tube", 1e-9), "--out", out))
    assert sentence.startswith("tube: tolerance 1e-09 % not met: bore_mm at 20 kPa: ± ")
    assert "on axisymmetric r4; 3 of 3 values miss it" in sentence
    assert "refined up to 500 unknowns" in sentence
    enough = reached_percent(sentence)
    assert f"set ask.tolerance_percent to {enough:g} or more" in sentence
    assert read_summary(out).dofs <= 500
    rows = read_rows(out / "rows.csv")
    for row in finest(rows, "bore_mm"):
        assert row.status.startswith(f"{NOT_MET}: ± ") and row.status.endswith("% reached, 1e-09 % asked")
        assert row.level == "r4" and abs(row.error_percent) < enough
    assert {r.status for r in rows if r.level != "r4"} == {REACHED}
    summary = read_summary(out)
    assert summary.status == NOT_MET and summary.reason in sentence
    assert read_summary(out / "axisymmetric-r4").status == REACHED  # its mesh is not to blame
    again = run("solve", scene("exact/tube", enough), "--out", out)
    assert again.exit_code == 0, again.output
    assert read_summary(out).status == REACHED
    assert {r.status for r in read_rows(out / "rows.csv")} == {REACHED}


@pytest.mark.usefixtures("no_finer")
def test_programs_are_told_too(scene, tmp_path) -> None:
    result = run("solve", scene("exact/tube", 1e-9), "--out", tmp_path / "out", "--json")
    assert result.exit_code == 3
    content = json.loads(result.stdout)
    assert content["reached"] is True and "not met" in content["verdict"]
    assert [m["pressure_kpa"] for m in content["missed"]] == [10.0, 20.0, 30.0]
    assert all(m["reached_percent"] > m["asked_percent"] == 1e-9 for m in content["missed"])
    assert [r["status"].split(":")[0] for r in content["rows"] if r["level"] == "r4"] == [NOT_MET] * 3


@pytest.mark.usefixtures("no_finer")
@pytest.mark.parametrize(
    ("name", "model", "quantity"),
    [
        ("exact/sphere-limit", "", "limit_kpa"),
        ("exact/sphere", "sector", "bore_mm"),
        ("exact/sphere", "full3d", "bore_mm"),
        ("exact/cylinder", "", "axial_force_n"),
        ("exact/cook", "", "corner_mm"),
        ("exact/ring-2", "", "crossing_kpa"),
        ("exact/cube", "", "crossing_kpa"),
        ("exact/ventricle", "", "apex_outside_mm"),
    ],
)
def test_no_body_model_or_quantity_is_spared(scene, tmp_path, monkeypatch, name, model, quantity) -> None:
    monkeypatch.setattr(bodies, "AROUND_LEVELS", {"hexahedra": ("n8", "n16"), "tetrahedra": ("n8", "n12")})
    monkeypatch.setattr(bodies, "CYLINDER_LEVELS", {"hexahedra": ("n6", "n8")})
    monkeypatch.setattr(bodies, "MERIDIAN_LEVELS", ("r1", "r2"))
    monkeypatch.setattr(bodies, "COOK_LEVELS", ("n4", "n8"))
    out = tmp_path / "out"
    sentence = said(run("solve", scene(name, 1e-10), "--out", out, *(["--model", model] if model else [])))
    rows = read_rows(out / "rows.csv")
    assert all(r.status.startswith(NOT_MET) for r in finest(rows, quantity))
    asked = [r for r in rows if r.status.startswith(NOT_MET)]
    worst = max(asked, key=lambda r: r.uncertainty / abs(r.value))
    at = "" if worst.pressure_kpa != worst.pressure_kpa else f" at {worst.pressure_kpa:g} kPa"
    assert f"not met: {worst.quantity}{at}: ± " in sentence
    assert ("--model axisymmetric" in sentence) == bool(model)


def test_users_meshes_are_not_spared_either(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(MOST_UNKNOWNS, "full3d", 60_000)  # its edges are halved once
    out = tmp_path / "out"
    sentence = said(run("solve", scene("exact/mesh", 1e-10), "--out", out))
    assert "on full3d m2; 4 of 4 values miss it" in sentence and "--model" not in sentence
    assert sum(r.status.startswith(NOT_MET) for r in read_rows(out / "rows.csv")) == 4


def test_one_mesh_tells_no_error_and_that_is_said(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(bodies, "USER_LEVELS", ("m1",))
    result = run("solve", EXACT / "mesh.toml", "--out", tmp_path / "out")
    assert result.exit_code == 3, result.output
    said = " ".join(result.stderr.split())
    assert "tolerance 1 % not met" in said and "no second mesh confirms it" in said and "give a coarser mesh" in said


@pytest.mark.usefixtures("no_finer")
def test_a_batch_has_the_worst_exit_code_and_its_report_says_why(scene, tmp_path) -> None:
    out = tmp_path / "out"
    scenes = scene("exact/tube", 1e-9), scene("exact/tube-ogden", 1.0)
    result = run("batch", *scenes, "--out", out)
    assert result.exit_code == 3
    assert "tube: tolerance 1e-09 % not met" in result.stderr and "tube-ogden: tolerance" not in result.stderr
    assert run("report", out).exit_code == 0
    page = (out / "report.md").read_text(encoding="utf-8")
    assert page.count(f"{NOT_MET}: ± ") == 1  # in the summary, of the tube


def test_studies_of_fixed_meshes_are_not_asked_for_a_tolerance(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(bodies, "AROUND_LEVELS", {"hexahedra": ("n8",), "tetrahedra": ("n8",)})
    path, out = scene("exact/tube", 1e-9), tmp_path / "out"
    found = load_scene(path)
    assert isinstance(found, BodyScene)
    result = run_all_models(found, path.read_text(), out, MPI.COMM_SELF, Progress(MPI.COMM_SELF))
    assert result.reached and not result.missed and {r.status for r in result.rows} == {REACHED}
    assert not (out / "axisymmetric-r8").exists()


# --- a bellows ----------------------------------------------------------------------------------------------

SHORT = (("pressure_kpa = [10.0]", "pressure_kpa = [2.0, 4.0]"), ('model = "meshed"', 'model = "rigid"'))


@pytest.mark.usefixtures("no_finer")
@pytest.mark.parametrize("model", ["axisymmetric", "sector", "full3d"])
def test_bellows_that_miss_it_exit_3_in_every_model(scene, tmp_path, model: str) -> None:
    out = tmp_path / "out"
    sentence = said(run("solve", scene("peers/bellows", 1e-4, *SHORT), "--out", out, "--model", model))
    assert re.search(rf"tip_mm at [24] kPa: ± \S+ % reached on {model} \w+; 2 of 2 values miss it", sentence)
    assert ("--model axisymmetric" in sentence) == (model != "axisymmetric")
    rows = read_rows(out / "rows.csv")
    missed = [r for r in rows if r.status.startswith(NOT_MET)]
    assert {(r.model, r.quantity) for r in missed} == {(model, "tip_mm")} and len(missed) == 2
    assert read_summary(out).status == NOT_MET
    assert run("report", out).exit_code == 0
    page = (out / "report.md").read_text(encoding="utf-8")
    assert re.search(rf"asked for (2, )?4 kPa: {NOT_MET}: ± ", page)


@pytest.mark.usefixtures("no_finer")
def test_a_blocked_tip_is_asked_for_its_force_and_not_for_its_place(scene, tmp_path) -> None:
    out = tmp_path / "out"
    blocked = ("pressure_kpa = [2.0, 4.0]", 'pressure_kpa = [2.0, 4.0]\ntip = "blocked"')
    sentence = said(run("solve", scene("peers/bellows", 1e-4, *SHORT, blocked), "--out", out))
    assert "tip_force_n at" in sentence and "2 of 2 values" in sentence
    assert {r.quantity for r in read_rows(out / "rows.csv") if r.status.startswith(NOT_MET)} == {"tip_force_n"}


def test_a_body_is_refined_where_its_error_is_and_only_as_far_as_allowed(scene, tmp_path, monkeypatch) -> None:
    # 8 cells round leave more than the meridian does here
    out = tmp_path / "out"
    path = scene("peers/bellows", 0.06, *SHORT)
    monkeypatch.setitem(MOST_UNKNOWNS, "sector", 0)
    first = run("solve", path, "--out", out, "--model", "sector")
    bodies_before = sorted(p.name for p in out.glob("sector-*"))
    assert first.exit_code == 3 and len(bodies_before) == 1
    monkeypatch.setitem(MOST_UNKNOWNS, "sector", 100_000)
    second = run("solve", path, "--out", out, "--model", "sector")
    assert second.exit_code == 0, second.output
    assert len(list(out.glob("sector-*"))) > 1
    rows = finest(read_rows(out / "rows.csv"), "tip_mm")
    assert all(r.uncertainty <= 6e-4 * r.value for r in rows)


@pytest.mark.usefixtures("no_finer")
def test_a_sweep_says_it_in_its_rows_and_exits_3(tmp_path) -> None:
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    file.write_text(
        'base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.convolutions = [1]\ngeometry.wall_mm = [1.5, 2.0]\n'
        "[ask]\npressure_kpa = [2.5]\ntolerance_percent = 1e-4\n",
        encoding="utf-8",
    )
    result = run("sweep", file, "--out", out)
    assert result.exit_code == 3
    assert "2 of 2 scenes do not hold the tolerance" in result.stderr
    for row in read_table(out / "sweep.csv"):
        assert row.status.startswith(f"{NOT_MET}: ± ") and row.reached and row.axisymmetric > 0.0


@pytest.mark.parametrize("name", ["exact/sphere-yeoh", "exact/sphere-limit", "smoke-t2-ri5"])
def test_meshes_of_elements_that_lock_confirm_nothing(scene, tmp_path, name) -> None:
    # a drawn scene had 1.295 +- 0.018 mm by three meshes where 1.235 is right, and exit 0
    path = scene(name, 50.0)
    text = re.sub(r"kappa_over_mu = \S+\n", "", path.read_text(encoding="utf-8"))
    text = re.sub(r"\[mesh\]\n(\w+ = .*\n)*", "", text).replace("[material]", "[material]\nkappa_over_mu = 1000.0")
    path.write_text(text + '\n[mesh]\nelement = "tet-p1"\n', encoding="utf-8")
    result = run("solve", path, "--out", tmp_path / "out")
    assert result.exit_code == 3, result.output
    assert "Linear displacements lock" in result.stderr and 'mesh.element = "auto"' in result.stderr
