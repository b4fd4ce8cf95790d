"""The error model: what it says of scenes, its fit on made-up samples, and its choice of meshes."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from studies.cost.error_model.cases import FINEST, KINDS, TRAINING, Trial, check_scenes, in_cells, training_scenes
from studies.cost.error_model.checks import CHECKED, CHOSEN, check_rows, factors
from studies.cost.error_model.fit import Sample, fit, limits_of, sample, time_laws
from studies.cost.error_model.study import STUDY
from studies.engine import run
from studies.planning import error_model
from studies.planning.error_model import (
    FITS,
    Cells,
    checked_error_percent,
    choose,
    explain,
    features,
    meridians_for,
    predicted_error_percent,
    predicted_seconds,
    predicted_unknowns,
)
from studies.planning.levels import MERIDIANS
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import read_rows, row
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_meridian


def actuator() -> BellowsScene:
    return load_bellows(provenance.ROOT / "scenes" / "heung-t2-ri5.toml")


def with_tolerance(scene: BellowsScene, percent: float) -> BellowsScene:
    return scene.model_copy(update={"ask": scene.ask.model_copy(update={"tolerance_percent": percent})})


def as_whole(scene: BellowsScene) -> BellowsScene:
    return scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"symmetry": "off"})})


def made_up_samples(power: float, count: int = 12) -> list[Sample]:
    """Errors of the second order that are a power of the first feature; true tips 10 mm."""
    random = np.random.default_rng(1)
    found = []
    for k in range(count):
        of = tuple(random.uniform(-1.0, 1.0, 7))
        error = math.exp(power * of[0])
        tips: dict[int, tuple[float, ...]] = {
            level: (10.0 * (1.0 + 0.01 * error / level**2),) for level in (*MERIDIANS, FINEST)
        }
        nothing = dict.fromkeys(tips, 1)
        found.append(Sample(f"s{k}", "hex", of, tips, dict.fromkeys(tips, 1.0), nothing))
    return found


def test_ten_check_scenes_span_what_they_should_and_are_not_trained_on() -> None:
    scenes = check_scenes()
    assert len(scenes) == 10
    assert {scene.material.law for scene in scenes} == {"yeoh", "ogden"}
    assert len({(s.rings.seat_mm, s.geometry.fillet_mm, s.geometry.half_pitch_mm) for s in scenes}) == 3
    assert {0.5, 2.0} <= {scene.geometry.wall_mm for scene in scenes}
    assert {4.0, 10.0} <= {scene.geometry.root_radius_mm for scene in scenes}
    pressures = [p for scene in scenes for p in scene.load.pressure_kpa]
    assert min(pressures) == 2.0 and max(pressures) == 20.0
    trained = {repr(scene.geometry) for scene in training_scenes()}
    assert len(trained) == TRAINING and not trained & {repr(scene.geometry) for scene in scenes}


def test_training_scenes_are_always_the_same() -> None:
    assert training_scenes() == training_scenes()


@pytest.mark.parametrize("cells", ["hex", "tet"])
@pytest.mark.parametrize("level", [1, 2])
def test_unknowns_are_counted_before_meshing(cells: Cells, level: int) -> None:
    scene = in_cells(actuator(), cells)
    mesh = scene_meridian(scene, level)
    pressures = 3 * len(mesh.cells) if cells == "hex" else len(mesh.corners)
    assert predicted_unknowns(scene, "axisymmetric", f"r{level}") == pytest.approx(
        2 * len(mesh.points) + pressures, rel=0.01
    )


def test_a_body_known_from_the_readme_is_counted() -> None:
    assert predicted_unknowns(as_whole(actuator()), "full3d", "n8") == pytest.approx(77_165, rel=0.01)
    assert predicted_unknowns(as_whole(actuator()), "full3d", "n16") == pytest.approx(154_805, rel=0.01)


def test_a_quarter_has_a_quarter_of_the_unknowns() -> None:
    whole = predicted_unknowns(as_whole(actuator()), "full3d", "n8")
    for model in ("sector", "full3d"):
        assert predicted_unknowns(actuator(), model, "n8") == pytest.approx(0.25 * whole)
    assert predicted_unknowns(actuator(), "full3d", "n12") > whole  # no multiple of 8: solved as a whole


@pytest.mark.parametrize("cells", ["hex", "tet"])
def test_finer_is_predicted_more_exact_and_slower(cells: Cells) -> None:
    scene = in_cells(actuator(), cells)
    errors = [predicted_error_percent(scene, "axisymmetric", f"r{level}") for level in MERIDIANS]
    seconds = [predicted_seconds(scene, "axisymmetric", f"r{level}") for level in MERIDIANS]
    assert errors == sorted(errors, reverse=True)
    assert seconds == sorted(seconds)
    bodies = [predicted_error_percent(scene, "full3d", level) for level in ("n8", "n12")]
    assert bodies[0] > bodies[1] > errors[0]


def test_choice_follows_the_tolerance() -> None:
    loose, tight = (choose(with_tolerance(actuator(), percent), "axisymmetric") for percent in (5.0, 0.03))
    assert loose.within and loose.level == "r1"
    assert int(tight.level[1:]) > 1
    impossible = choose(with_tolerance(actuator(), 0.001), "axisymmetric")
    assert not impossible.within and impossible.level == "r4"


def test_what_is_left_out_is_told_with_what_it_saves() -> None:
    scene = with_tolerance(actuator(), 5.0)
    choice = choose(scene, "axisymmetric")
    lines = explain(scene, choice, one_mesh=False)
    assert meridians_for(choice) == (1, 2)
    assert "r1: error" in lines[0]
    assert any(line.startswith("skipped: axisymmetric r4,") for line in lines)
    assert any(line.startswith("skipped: full3d n8") for line in lines)
    body = explain(scene, choose(scene, "full3d"), one_mesh=True)
    assert any(line.startswith("skipped: full3d n8r2") for line in body)
    of_whole = explain(as_whole(scene), choose(as_whole(scene), "full3d"), one_mesh=False)
    assert any(line.startswith("skipped: full3d n6r2") for line in of_whole)


def test_two_levels_of_the_scene_itself_tell_the_error() -> None:
    ratio = FITS["hex"].ratios
    assert checked_error_percent("hex", 2, [10.0, 20.0], [10.1, 20.6]) == pytest.approx(3.0 * ratio[1])
    assert checked_error_percent("hex", 1, [10.0], [10.1]) == pytest.approx(1.0 * ratio[0])
    assert checked_error_percent("hex", 2, [10.0], [10.0]) == error_model.FLOOR_PERCENT
    assert checked_error_percent("hex", 2, [10.0, math.nan], [10.1, 20.0]) == pytest.approx(1.0 * ratio[1])


def test_fit_finds_the_law_it_was_given() -> None:
    samples = made_up_samples(0.7)
    found = fit(samples, {s.scene: (10.0,) for s in samples}, "hex")
    assert found.slopes[0] == pytest.approx(0.7, abs=0.1)
    assert max(abs(s) for s in found.slopes[1:]) < 0.1
    assert found.constants[0] - found.constants[1] == pytest.approx(math.log(4.0), abs=0.15)
    assert found.ratios == pytest.approx((4.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0), rel=0.05)


def test_limits_are_extrapolated() -> None:
    assert all(limit == pytest.approx(10.0, rel=1e-3) for (limit,) in limits_of(made_up_samples(0.0)).values())


def test_time_laws_from_rows_of_the_cost_study() -> None:
    rows = [
        row("peer-bellows", quantity, "1", 10.0, "full3d", value, f"hex n{n} warm 2x1")
        for n in (8, 16, 32)
        for quantity, value in (
            ("wall_s", 9.0 + n),
            ("work_s", 1e-3 * n**1.5),
            ("unknowns", float(n)),
            ("others_cpu_s", 0.0),
        )
    ]
    (law,) = time_laws(rows).values()
    assert law.exponent == pytest.approx(1.5) and law.at(8.0) == pytest.approx(1e-3 * 8**1.5, rel=0.01)


def test_one_small_scene_from_runs_to_rows(tmp_path: Path) -> None:
    scene = training_scenes()[3]
    found = sample(Trial(scene, "hex"), (1, 2, 4), tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF))
    assert found.unknowns[2] > found.unknowns[1]
    assert found.features == features(in_cells(scene, "hex"))
    rows = check_rows(scene, found, {scene.name: found.limits_mm()})
    checked = factors(rows, CHECKED, "hex")
    assert len(checked) == len(MERIDIANS)
    assert all(factor >= 1.0 for factor in checked.values())


def test_page_of_made_up_samples(tmp_path: Path) -> None:
    """Constants of the fit, and the check of scenes that it was not fitted to."""
    made_up = made_up_samples(0.7)
    scenes = training_scenes()[:10] + check_scenes()[:2]
    samples = {
        (scene.name, cells): dataclasses.replace(of, scene=scene.name, cells=cells)
        for scene, of in zip(scenes, made_up, strict=True)
        for cells in KINDS
    }
    study = dataclasses.replace(
        STUDY,
        cases=lambda _: [Trial(scene, cells) for cells in KINDS for scene in scenes],
        solve=lambda trial, at: samples[trial.scene.name, trial.cells],
    )
    assert run(study, tmp_path, MPI.COMM_SELF, {"cost": tmp_path / "none.csv"}) == 0
    rows = read_rows(tmp_path / "rows.csv")
    assert [(r.scene, r.level[:3]) for r in rows if r.quantity == CHOSEN] == [
        (scene.name, cells) for cells in KINDS for scene in scenes[10:]
    ]
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert 'FITS "hex": Fit(constants=' in text and 'FITS "tet": Fit(' in text
    assert len(json.loads((tmp_path / "samples.json").read_text(encoding="utf-8"))) == 24
