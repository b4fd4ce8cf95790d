"""The study of the unprinted dimensions: picks are the recorded sets, scenes the repository's, the report honest."""

from __future__ import annotations

import csv
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from analytical.bellows.chains import closed_form
from analytical.bellows.fit.masses import mass_allowed, rings_g, silicone_g
from analytical.bellows.fit.members import WITHIN, members_of
from analytical.bellows.loads import held_tip
from analytical.bellows.paper import FAMILIES, PRINTED, REFERENCE_FAMILY, actuators
from analytical.bellows.reading import BALANCED
from studies.dimensions.cases import Steps
from studies.dimensions.fit import Fit, Picks, fit, pick_sets
from studies.dimensions.predictions import QUANTITIES
from studies.dimensions.scenes import FITTINGS, buildable, scene_of, write_scenes
from studies.dimensions.study import STUDY, keep_scenes, recorded
from studies.engine import Setting, run
from studies.models.build import masses_g
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import read_rows
from studies.scene.bellows import dimensions_of
from studies.scene.load import load_bellows
from studies.scene.materials import law_of
from studies.scene.meshes import scene_meridian

TWELVE = [actuator for family in FAMILIES for actuator in actuators(family)]
every_actuator = pytest.mark.parametrize("actuator", TWELVE, ids=[actuator.name for actuator in TWELVE])


def test_the_rule_picks_the_recorded_sets() -> None:
    picks = pick_sets()
    assert picks.families == FAMILIES
    assert picks.as_recorded
    # the rule of the fit
    assert np.abs(picks.sets.error).max() <= WITHIN
    assert picks.sets.error.shape == (3, 4)


def test_recorded_sets_may_weigh_what_they_do_with_and_without_rings() -> None:
    members = members_of(FAMILIES)
    silicone = silicone_g(members, FITTINGS)
    assert mass_allowed(silicone).all()
    assert mass_allowed(silicone + rings_g(members, FITTINGS)).all()


@every_actuator
def test_estimated_mass_against_the_mesh(actuator) -> None:
    scene = scene_of(actuator)
    family = next(f for f in FAMILIES if actuator in actuators(f))
    column = [a.name for a in actuators(family)].index(actuator.name)
    members = members_of((family,))
    silicone, rings = masses_g(scene, scene_meridian(scene, 1))
    # sharp corners for arcs: 12 % at the worst, where arcs of a 2 mm wall fill the half pitch
    assert silicone_g(members, FITTINGS)[0, column] == pytest.approx(silicone, rel=0.12)
    # edges of 0.5 mm radius are rounded off the rings: 0.11 of 8 mm2, nearer the outside
    assert rings_g(members, FITTINGS)[0, column] == pytest.approx(rings, rel=0.02)


def test_what_can_be_built() -> None:
    # e = seat/2 + 2 fillet + wall = 5 mm is the least for the 2 mm wall, R_p - R_i = 2 fillet + wall = 3 mm too
    families = (
        REFERENCE_FAMILY,
        replace(REFERENCE_FAMILY, half_pitch_mm=4.5),
        replace(REFERENCE_FAMILY, larger_root_radius_mm=7.5),
        replace(REFERENCE_FAMILY, larger_root_radius_mm=8.0),
    )
    assert list(buildable(members_of(families))) == [True, False, True, False]


# --- scenes ---------------------------------------------------------------------------------


@every_actuator
def test_scene_files_are_what_the_study_writes(actuator, root, tmp_path) -> None:
    write_scenes(tmp_path, FAMILIES)
    name = f"{actuator.name}.toml"
    ours, written = (folder / name for folder in (root / "scenes", tmp_path))
    assert tomllib.loads(ours.read_text(encoding="utf-8")) == tomllib.loads(written.read_text(encoding="utf-8"))
    scene = load_bellows(ours)
    assert scene.name == actuator.name
    assert dimensions_of(scene) == actuator.dimensions
    law, known = law_of(scene.material), actuator.law
    # the constants go through kPa in decimals
    for stretch in (1.1, 4.0):
        here, there = (x.stress_difference(stretch, 1.0 / stretch, 1.0) for x in (law, known))
        assert here == pytest.approx(there, rel=1e-12)


def test_scene_files_say_what_is_printed_inferred_and_chosen(root) -> None:
    text = (root / "scenes" / "heung-b-t2-ri7.5.toml").read_text(encoding="utf-8")
    lines = {line.split(" = ")[0]: line for line in text.splitlines()}
    assert lines["wall_mm"].endswith("(printed)")
    for key in ("root_radius_mm", "crest_radius_mm", "half_pitch_mm", "convolutions"):
        assert lines[key].endswith("(inferred)")
    assert "the rest is chosen" in text
    assert "Alternate set b" in text
    five = (root / "scenes" / "heung-t2-ri5.toml").read_text(encoding="utf-8")
    assert "R_i, cavity side (printed)" in five
    assert "Alternate" not in five


# --- what was not fitted --------------------------------------------------------------------


def test_predictions_against_single_actuators() -> None:
    members = members_of(FAMILIES)
    found = {q.label: q.measure(members) for q in QUANTITIES}
    for k, family in enumerate(FAMILIES):
        for j, actuator in enumerate(actuators(family)):
            d, law = actuator.dimensions, actuator.law
            expected = {
                "elongation at 10 kPa, corrected chain": closed_form(d, law, 10.0).elongation_mm,
                "elongation at 20 kPa, balanced chain": closed_form(d, law, 20.0, BALANCED).elongation_mm,
                "full unfolding, corrected chain": closed_form(d, law, 0.0).unfolding_pressure_kpa,
                "force at the blocked tip, 20 kPa": held_tip(d, law, 20.0).tip_force_n,
                "length at rest": np.array([2 * d.convolutions * d.half_pitch_mm + 6.0]),
            }
            for label, (value,) in expected.items():
                # alone and in arrays: round-off of the root finders
                assert found[label][k, j] == pytest.approx(value, rel=1e-9)


# --- scenes that are requested --------------------------------------------------------------


@pytest.mark.parametrize("as_recorded", [True, False])
def test_scenes_are_written_only_if_the_record_holds(as_recorded, tmp_path, monkeypatch) -> None:
    nobody = members_of(())
    picks = Picks(nobody, np.array([], dtype=bool), nobody, FAMILIES if as_recorded else FAMILIES[::-1])
    monkeypatch.setattr(provenance, "ROOT", tmp_path)
    at = Setting(tmp_path / "out", MPI.COMM_WORLD, Progress(MPI.COMM_WORLD), {"write_scenes": True})
    keep_scenes(picks, at)
    names = sorted(actuator.name for actuator in TWELVE)
    assert sorted(path.stem for path in (tmp_path / "out" / "scenes").glob("*.toml")) == names
    assert sorted(path.stem for path in (tmp_path / "scenes").glob("*.toml")) == (names if as_recorded else [])
    assert recorded(picks).met == as_recorded
    assert ("edit FAMILIES" in recorded(picks).found) != as_recorded


# --- the report -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found() -> Fit:
    """All that is found: half a minute."""
    return fit(Steps())


@pytest.fixture(scope="module")
def folder(found: Fit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the study writes of it."""
    out = tmp_path_factory.mktemp("dimensions")
    study = replace(STUDY, solve=lambda steps, at: found)
    assert run(study, out, MPI.COMM_WORLD, {"write_scenes": False}) == 0
    return out


@pytest.mark.slow
def test_report_says_that_nothing_is_validated(folder: Path) -> None:
    text = (folder / "report.md").read_text(encoding="utf-8")
    assert "validates\nnothing" in text
    assert "because it was made to" in text
    assert "analytical/bellows/paper.py records | the same | met |" in text
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count('src="data:image/png;base64,') == 4
    assert 'src="pictures' not in page


@pytest.mark.slow
def test_rows_hold_the_fitted_numbers_and_the_ranges(folder: Path) -> None:
    rows = read_rows(folder / "rows.csv")
    fitted = [r for r in rows if (r.quantity, r.model, r.pressure_kpa) == ("tip_mm", "closed_form", 20.0)]
    assert [r.scene for r in fitted] == [actuator.name for actuator in TWELVE]
    for r in fitted:
        # the rule of the fit
        assert abs(r.error_percent) <= 100.0 * WITHIN
        assert "no validation" in r.source
    for printed, short in zip(PRINTED, ("t1-ri5", "t1-larger-ri", "t2-ri5", "t2-larger-ri"), strict=True):
        ends = [r.value for r in rows if r.scene == f"all-that-fit-{short}" and r.pressure_kpa == 10.0]
        assert len(ends) == 2
        assert 0.0 < ends[0] < ends[1] < 10.0 * printed.closed_form_cm * (1.0 + WITHIN)
    folded = [r for r in rows if r.status == "past the model"]
    assert {r.model for r in folded} == {"closed_form_printed"}


@pytest.mark.slow
def test_members_file_lists_all_sets_that_fit(folder: Path, found: Fit) -> None:
    with (folder / "members.csv").open(encoding="utf-8") as stream:
        lines = list(csv.DictReader(stream))
    assert len(lines) == len(found.fitting)
    assert sum(line["mass_allowed"] == "yes" for line in lines) == len(found.members)
    assert all(float(line["worst_error_percent"]) <= 100.0 * WITHIN for line in lines)
    # more than the sets to work with: the fit is not unique
    assert len(lines) > 100
    assert (found.refined.worst_error <= WITHIN).all()


@pytest.mark.slow
def test_a_finer_grid_moves_the_pick_to_the_bound(found: Fit) -> None:
    coarse, middle, fine = (rule.pick for rule in found.rules if rule.shapes == "buildable")
    for pick in (coarse, middle):
        assert pick.family(0) == REFERENCE_FAMILY
    # "at the bound": within half a percent of it
    assert fine.worst_error[0] > WITHIN - 0.005
