"""A blocked tip and a pulled one as scenes: forces in path.csv and rows, all models, two ranks, refusals."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from click.testing import CliRunner

from analytical.bellows.loads import held_tip
from studies.__main__ import main
from studies.planning.planner import describe, make_plan
from studies.results.rows import read_rows
from studies.results.run_files import read_path, read_summary
from studies.results.runs import run_hash
from studies.scene.bellows import dimensions_of
from studies.scene.load import load_bellows
from studies.scene.materials import law_of
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]
INLET_MM2 = math.pi * 10.5**2


@pytest.fixture(scope="module")
def write(tmp_path_factory):
    """A scene of one convolution at 5 kPa with keys added to its load."""
    folder = tmp_path_factory.mktemp("tips")

    def make(name: str, load: str, tip: str = "rigid", pressure: str = "5.0") -> Path:
        text = (ROOT / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
        text = text.replace("convolutions = 2", "convolutions = 1").replace("smoke-t2-ri5", name)
        text = text.replace("[5.0, 10.0]", f"[{pressure}]").replace('tip = "cap"', f'tip = "{tip}"')
        path = folder / f"{name}.toml"
        path.write_text(text.replace('control = "auto"', f'control = "auto"\n{load}'), encoding="utf-8")
        return path

    return make


def solve(scene: Path, model: str = ""):
    """Last row and folder; without a model the axisymmetric one, on as many meshes as it needs."""
    out = scene.parent / f"{scene.stem}-{model}"
    result = CliRunner().invoke(main, ["solve", str(scene), "--out", str(out), *(["--model", model] if model else [])])
    assert result.exit_code == 0, result.output
    return read_path(out)[-1], out


@pytest.fixture(scope="module")
def whole(write):
    """The blocked plate in full 3D: last row and folder."""
    return solve(write("plate", 'tip = "blocked"'), "full3d")


def test_blocked_plate_in_full_3d(whole) -> None:
    row, out = whole
    assert row.tip_mm == row.tip_centre_mm == 0.0
    # the inlet's area, 1e-3 off as meshed with 8 cells round
    assert row.reaction_n + 5e-3 * INLET_MM2 == pytest.approx(row.tip_force_n, rel=2e-3)
    assert row.unstable_modes == 0  # one convolution is too short to bend sideways
    rows = {(r.quantity, r.model, r.level): r for r in read_rows(out / "rows.csv")}
    found = rows["tip_force_n", "full3d", "n8"]
    assert found.unit == "N" and found.value == pytest.approx(row.tip_force_n, rel=1e-8)  # nine digits
    assert 0.0 < found.uncertainty < 0.05 * found.value
    assert rows["tip_mm", "full3d", "n8"].value == 0.0


def test_rows_have_the_closed_forms_force_and_its_lower_bound(write, whole) -> None:
    scene = load_bellows(write("plate", 'tip = "blocked"'))
    expected = held_tip(dimensions_of(scene), law_of(scene.material), 5.0)
    rows = [r for r in read_rows(whole[1] / "rows.csv") if r.model == "closed_form"]
    found = {r.quantity: r.value for r in rows}
    assert found == pytest.approx(
        {"tip_force_n": expected.tip_force_n[0], "extension_force_n": expected.extension_force_n[0]}, rel=1e-8
    )
    row, _ = solve(write("plate", 'tip = "blocked"'), "closed_form")
    assert (row.tip_mm, row.tip_force_n) == (0.0, pytest.approx(expected.tip_force_n[0], rel=1e-11))


def test_report_of_a_blocked_scene_is_about_the_force(whole) -> None:
    row, out = whole
    result = CliRunner().invoke(main, ["report", str(out)])
    assert result.exit_code == 0, result.output
    text = (out / "report.md").read_text(encoding="utf-8")
    assert "### Force at the blocked tip by pressure and model" in text
    assert f"| {row.tip_force_n:.3f} ± " in text and "### Elongation" not in text
    assert "Models beside each other: axisymmetric within" in text
    assert "extension_force_n" in text  # a buckling wall's, said in a note


@pytest.mark.parametrize("tip", ["rigid", "cap"])
def test_models_and_tips_agree_on_the_force(write, whole, tip: str) -> None:
    row, _ = solve(write(f"{tip}-flat", 'tip = "blocked"', tip))
    assert row.tip_mm == 0.0
    # a meridian's inlet is a true circle; Newton's residual, 1e-8 of the load, and digits
    assert row.reaction_n + 5e-3 * INLET_MM2 == pytest.approx(row.tip_force_n, abs=1e-7)
    # 8 cells round, and a cap that bulges against a plate that does not
    assert row.tip_force_n == pytest.approx(whole[0].tip_force_n, rel=2e-2)


def test_two_ranks_find_the_same_force(python, write, whole) -> None:
    scene = write("plate", 'tip = "blocked"')
    out = scene.parent / "ranks"
    python.run(2, "-m", "studies", "solve", scene, "--out", out, "--model", "full3d")
    assert read_summary(out).ranks == 2
    one, two = whole[0], read_path(out)[-1]
    for name in ("tip_force_n", "reaction_n", "volume_mm3", "energy_mj"):
        # Newton to 1e-8 of the load from the same guess; sums in another order
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-7), name
    assert two.unstable_modes == one.unstable_modes


def test_dead_force_and_tip_force_have_opposite_signs(write) -> None:
    pulled, out = solve(write("pulled", "tip_force_n = 0.1"), "sector")
    flat = read_path(out / "axisymmetric-r1")[-1]
    free, _ = solve(write("free", ""))
    assert free.tip_force_n == 0.0
    for row in (pulled, flat):
        assert row.tip_force_n == pytest.approx(-0.1, rel=1e-12)
        assert row.tip_mm > free.tip_mm + 0.1
    assert pulled.tip_mm == pytest.approx(flat.tip_mm, rel=1e-2)  # 8 cells round
    assert flat.reaction_n + 5e-3 * INLET_MM2 + 0.1 == pytest.approx(0.0, abs=1e-7)  # as above
    closed = [r for r in read_rows(out / "rows.csv") if r.model.startswith("closed_form") and r.quantity == "tip_mm"]
    assert all(math.isnan(r.value) and "no force on its tip" in r.status for r in closed) and closed


@pytest.mark.parametrize(
    ("load", "tip", "said"),
    [
        ('tip = "blocked"\ntip_force_n = 1.0', "rigid", ["load.tip_force_n = 1", 'load.tip = "free"']),
        ("tip_force_n = 1.0", "cap", ["load.tip_force_n = 1", 'geometry.tip = "rigid"']),
        ("tip_force_n = inf", "rigid", ["load.tip_force_n = inf", "finite"]),
        ('tip = "clamped"', "cap", ["load.tip = 'clamped'", "'blocked'"]),
    ],
)
def test_wrong_tips_are_refused(write, load: str, tip: str, said: list[str]) -> None:
    with pytest.raises(SceneError) as refusal:
        load_bellows(write("wrong", load, tip))
    for words in said:
        assert words in str(refusal.value)


def test_force_of_a_free_tip_cannot_be_asked_for(write) -> None:
    path = write("requested", "")
    path.write_text(path.read_text().replace('["tip_mm"]', '["tip_force_n"]'), encoding="utf-8")
    with pytest.raises(SceneError, match='set load.tip = "blocked"'):
        load_bellows(path)


def test_closed_form_of_a_loaded_tip_is_refused_as_a_model(write) -> None:
    scene = load_bellows(write("loaded", "tip_force_n = 1.0"))
    with pytest.raises(SceneError, match="no force on its tip"):
        make_plan(scene, "closed_form")


def test_plan_says_what_is_not_seen_of_a_blocked_tip_whose_modes_are_not_counted(write) -> None:
    scene = load_bellows(write("seen", 'tip = "blocked"'))
    text = describe(scene, make_plan(scene))
    assert "blocked tip" in text
    assert "modes that bend the actuator sideways" not in text
    unseen = scene.model_copy(update={"ask": scene.ask.model_copy(update={"modes": False})})
    assert "modes that bend the actuator sideways" in describe(unseen, make_plan(unseen))


def test_tip_is_part_of_a_runs_identity(write) -> None:
    hashes = {
        run_hash(load_bellows(write("one", load)), "axisymmetric", "r1")
        for load in ("", 'tip = "blocked"', "tip_force_n = 0.1")
    }
    assert len(hashes) == 3
