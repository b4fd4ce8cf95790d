"""A force on the tip beside the pressure: in which order they come, which states that leads to, and what is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mpi4py import MPI

from solvers.errors import StepFailed
from solvers.paths.onset import bring_on
from solvers.paths.states import PathMemory
from studies.__main__ import main
from studies.models import run_log
from studies.models.axisymmetric import run_axisymmetric
from studies.progress import Progress
from studies.results.rows import read_rows
from studies.results.run_files import PathRow, read_path, read_summary
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]
ORDERS = ("force-first", "together", "pressure-first")


@pytest.fixture(scope="module")
def write(tmp_path_factory: pytest.TempPathFactory):
    """The actuator with a wall of 1 mm and two convolutions, its tip a plate, with keys added to its load."""
    folder = tmp_path_factory.mktemp("orders")

    def make(name: str, pressures: str, load: str) -> Path:
        text = (ROOT / "scenes" / "heung-t1-ri5.toml").read_text(encoding="utf-8")
        for old, new in (
            ("heung-t1-ri5", name),
            ("convolutions = 8", "convolutions = 2"),
            ('tip = "cap"', 'tip = "rigid"'),
            ("[5.0, 10.0, 15.0, 20.0]", pressures),
            ('control = "auto"', f'control = "auto"\n{load}'),
        ):
            assert old in text, old
            text = text.replace(old, new, 1)
        path = folder / f"{name}.toml"
        path.write_text(text.replace("fields = true", "fields = false"), encoding="utf-8")
        return path

    return make


def solve(scene: Path, *options: str) -> tuple[Result, Path]:
    out = scene.parent / f"{scene.stem}-{'-'.join(options)}"
    return CliRunner().invoke(main, ["solve", str(scene), "--out", str(out), *options]), out


def meridian(scene: BellowsScene, folder: Path) -> Run:
    """The path on the coarsest meridian."""
    return run_axisymmetric(scene, 1, folder, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))


def requested(out: Path) -> list[PathRow]:
    return [row for row in read_path(out) if row.status == "requested"]


@pytest.mark.parametrize("force", [0.2, -0.02])
def test_where_the_state_is_unique_every_order_leads_to_it(write, tmp_path: Path, force: float) -> None:
    tips = {}
    for order in ("auto", *ORDERS):
        scene = load_bellows(write(f"unique-{order}", "[2.0, 5.0]", f'tip_force_n = {force}\norder = "{order}"'))
        run = meridian(scene, tmp_path / order)
        assert run.summary.status == "reached", run.summary.reason
        assert [row.tip_force_n for row in run.requested] == [-force, -force]
        assert [row.unstable_modes for row in run.requested] == [0.0, 0.0]
        tips[order] = [row.tip_mm for row in run.requested]
    for order, found in tips.items():
        assert found == pytest.approx(tips["auto"], rel=1e-6), order
    assert tips["auto"] == tips["force-first"]  # which is what it is


def test_a_push_that_the_pressure_carries_is_lifted(write) -> None:
    scene = write("lifted", "[5.0, 10.0]", "tip_force_n = -1.0")
    result, out = solve(scene)
    assert result.exit_code == 0, result.output
    low, high = requested(out)
    for row in (low, high):
        assert row.tip_force_n == 1.0
        assert row.unstable_modes == 0.0
        # equilibrium of the whole, to Newton's residual: the inlet's area is that of the crest
        assert row.reaction_n + 1e-3 * row.pressure_kpa * 346.360590 == pytest.approx(1.0, abs=1e-6)
    assert 0.0 < low.tip_mm < high.tip_mm
    summary = read_summary(out)
    told = next(note for note in summary.plan if note.startswith("loads: "))
    assert "no equilibrium under the dead force of -1 N before the pressure comes: surfaces touch under -0." in told
    assert "loads: -1 N brought on after the pressure at 5 kPa" in summary.plan
    # without the force it stands further out; these rows are steps, of the mesh whose path is followed
    free = next(row for row in read_path(out / "axisymmetric-r1") if row.pressure_kpa == 5.0 and row.status == "step")
    assert free.tip_force_n == 0.0 and free.tip_mm > low.tip_mm
    together = meridian(load_bellows(write("joint", "[5.0]", 'tip_force_n = -1.0\norder = "together"')), out / "joint")
    by_pressure = next(row for row in read_path(out / "axisymmetric-r1") if row.status == "requested")
    assert together.requested[0].tip_mm == pytest.approx(by_pressure.tip_mm, rel=1e-6)


def test_pressures_that_do_not_lift_the_load_are_told_apart(write, tmp_path: Path) -> None:
    run = meridian(load_bellows(write("heavy", "[1.0, 5.0]", "tip_force_n = -1.0")), tmp_path)
    assert run.summary.status == "reached", run.summary.reason
    crushed, lifted = run.requested
    # at 1 kPa the folds are pressed together, and contact carries the load; at 5 kPa the pressure does
    assert crushed.tip_mm < -7.0 and crushed.min_gap_mm < 0.01
    assert lifted.tip_mm > 6.0 and lifted.min_gap_mm > 0.5
    assert lifted.unstable_modes == 0.0
    assert any("contact modelled beyond" in note and "with -0." in note for note in run.summary.plan)
    alone = meridian(
        load_bellows(write("alone", "[5.0]", 'tip_force_n = -1.0\norder = "together"')), tmp_path / "alone"
    )
    assert lifted.tip_mm == pytest.approx(alone.requested[0].tip_mm, rel=1e-6)


def test_a_pressure_without_a_state_is_named_and_the_others_are_solved(write, tmp_path: Path, monkeypatch) -> None:
    def fails_below(problem, factor, settings, state, start, end, accept=None):
        if end.pressure_mpa < 4e-3:
            raise StepFailed("no convergence; last state under -0.4 N at 2 kPa")
        yield from bring_on(problem, factor, settings, state, start, end, accept)

    monkeypatch.setattr("solvers.paths.orders.bring_on", fails_below)
    scene = write("gaps", "[2.0, 5.0, 10.0]", 'tip_force_n = -1.0\norder = "together"')
    result, out = solve(scene)
    assert result.exit_code == 3
    rows = [row for row in read_rows(out / "rows.csv") if row.quantity == "tip_mm" and row.model == "axisymmetric"]
    for row in rows:
        if row.pressure_kpa == 2.0:
            assert row.status.startswith("no state at 2 kPa: ") and "last state under -0.4 N" in row.status
        else:
            assert row.status == "reached" and row.value > 0.0
    assert "stopped early: no state at 2 kPa: -1 N, brought on in proportion with the pressure" in result.output
    assert read_summary(out).status == "stopped"


def test_a_force_that_nothing_carries_stops_by_name(write, tmp_path: Path, monkeypatch) -> None:
    def fails(problem, factor, settings, state, start, end, accept=None):
        raise StepFailed("no convergence; last state under -0.6 N at 0 kPa")

    monkeypatch.setattr("solvers.paths.onset.bring_on", fails)
    scene = load_bellows(write("nothing", "[5.0]", 'tip_force_n = -1.0\norder = "force-first"'))
    run = meridian(scene, tmp_path)
    assert run.summary.status == "stopped"
    reason = run.summary.reason
    assert "no equilibrium under the dead force of -1 N before the pressure comes: no convergence" in reason
    assert 'load.order = "pressure-first" brings the pressure on before the force' in reason


def test_the_whole_body_starts_from_the_lifted_state(write) -> None:
    result, out = solve(write("whole", "[5.0]", "tip_force_n = -1.0"), "--model", "full3d")
    assert result.exit_code == 0, result.output
    (row,) = requested(out)
    (flat,) = requested(out / "axisymmetric-r1")
    assert row.tip_mm == pytest.approx(flat.tip_mm, rel=2e-2)  # 8 cells round
    assert row.tip_force_n == pytest.approx(1.0, rel=1e-9)
    # held up straight it would bend out sideways: two modes of m = 1, which are two pairs of the whole body
    assert row.unstable_modes == 4.0
    assert "warning: unstable by the count of full3d: 5 kPa (4 modes)" in result.output
    result, out = solve(write("harmonics", "[5.0]", "tip_force_n = -1.0"))
    assert requested(out)[0].unstable_by_m == "0;2;0;0;0;0;0"
    assert "unstable against m = 1 (bends sideways) at 5 kPa (2 modes), from the first state on" in result.output


def test_an_interrupted_lift_goes_on_to_the_same_rows(write, tmp_path: Path, monkeypatch) -> None:
    scene = load_bellows(write("stopped", "[5.0, 10.0]", 'tip_force_n = -1.0\norder = "pressure-first"'))
    whole = meridian(scene, tmp_path / "whole")
    step, steps = run_log.Log.step, []

    def killed(self: run_log.Log, memory: PathMemory) -> None:
        step(self, memory)
        steps.append(memory)
        if len(steps) == 1:
            raise KeyboardInterrupt

    monkeypatch.setattr(run_log.Log, "step", killed)
    with pytest.raises(KeyboardInterrupt):
        meridian(scene, tmp_path / "part")
    resumed = meridian(scene, tmp_path / "part")
    assert resumed.summary.plan == whole.summary.plan
    assert [row.tip_mm for row in resumed.path] == pytest.approx([row.tip_mm for row in whole.path], rel=1e-9)


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ('order = "together"', ['load.order = "together"', "load.tip_force_n"]),
        ('tip = "blocked"\norder = "pressure-first"', ['load.order = "pressure-first"', "load.tip_force_n"]),
        ('tip_force_n = -1.0\norder = "tip-last"', ["load.order = 'tip-last'", "'force-first', 'together'"]),
    ],
)
def test_orders_that_cannot_be_are_refused(write, load: str, said: list[str]) -> None:
    with pytest.raises(SceneError) as refusal:
        load_bellows(write("wrong", "[5.0]", load))
    for words in said:
        assert words in str(refusal.value)
