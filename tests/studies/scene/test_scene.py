"""Scenes: the shipped ones are accepted, wrong ones are refused with key, value and what is allowed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studies.scene.bellows import bond_grade, shape_of
from studies.scene.load import load_bellows
from studies.scene.materials import inverse_kappa, law_of
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]
REFERENCE = (ROOT / "scenes" / "heung-t2-ri5.toml").read_text(encoding="utf-8")


@pytest.fixture
def changed(tmp_path):
    """Path of the reference scene with one text replaced."""

    def make(old: str, new: str) -> Path:
        assert old in REFERENCE
        path = tmp_path / "scene.toml"
        path.write_text(REFERENCE.replace(old, new), encoding="utf-8")
        return path

    return make


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.toml")), ids=lambda p: p.stem)
def test_shipped_scenes_are_accepted(path):
    scene = load_bellows(path)
    assert scene.name == path.stem
    assert len(shape_of(scene).crest_positions_mm) == scene.geometry.convolutions + 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("wall_mm = 2.0", "wal_mm = 2.0", ["geometry.wal_mm = 2.0", "did you mean wall_mm"]),
        ("wall_mm = 2.0", "wall_mm = -2.0", ["geometry.wall_mm = -2.0", "greater than 0 mm"]),
        ("wall_mm = 2.0", "wall_mm = 0.002", ["geometry.wall_mm = 0.002", "1/2000", "0.00525 mm"]),
        ("wall_mm = 2.0", "wall_mm = 4.0", ["half_pitch_mm = 5", "7 mm"]),
        ("wall_mm = 2.0", "wall_m = 0.002", ["geometry.wall_m = 0.002", "wall_mm"]),
        ("crest_radius_mm = 10.5", "crest_radius_mm = 4.0", ["crest_radius_mm = 4", "root_radius_mm = 5"]),
        ("collar_mm = 3.0", "collar_mm = 1.0", ["collar_mm = 1", "2.5 mm"]),
        ('model = "auto"', 'model = "soft"', ["rings.model = 'soft'", "'rigid'", "'meshed'"]),
        (
            'bond = "rigid"',
            'bond_grading_mm = 3.0\nbond = "adhesive"',
            ["rings.bond_grading_mm = 3", "seat_mm = 4"],
        ),
        ("[5.0, 10.0, 15.0, 20.0]", "[5.0, 5.0]", ["load.pressure_kpa = [5.0, 5.0]", "ascend"]),
        ("[5.0, 10.0, 15.0, 20.0]", "[-5.0, 5.0]", ["load.pressure_kpa = [-5.0, 5.0]", "descend from below 0"]),
        ("[5.0, 10.0, 15.0, 20.0]", "[0.0, 5.0]", ["load.pressure_kpa = [0.0, 5.0]", "from above 0"]),
        ("[5.0, 10.0, 15.0, 20.0]", "[20000.0]", ["20000", "units (kPa)"]),
        ('convention = "2mu/alpha^2"', "", ["material.convention", "missing"]),
        ('law = "ogden"', 'law = "hooke"', ["material.law = 'hooke'", "'yeoh'", "'ogden'"]),
        ("mu_kpa = 75.449", "mu_kpa = nan", ["material.mu_kpa = nan", "finite"]),
        ("alpha = 5.836", "alpha = 0.0", ["material", "alpha"]),
        ("convolutions = 8 ", "convolutions = 8.5 ", ["geometry.convolutions = 8.5"]),
        ("[material]", "[materiel]", ["materiel", "did you mean material"]),
        ("tolerance_percent = 1.0", "tolerance_percent = ", ["not a TOML file"]),
        ("crest_radius_mm = 10.5", "outer_diameter_mm = 3.0", ["outer_diameter_mm = 3", "two walls, 4 mm"]),
        ("crest_radius_mm = 10.5", "outer_diameter_mm = inf", ["outer_diameter_mm = inf", "finite"]),
        ("crest_radius_mm = 10.5", f"outer_diameter_mm = {10**400}", ["outer_diameter_mm", "finite"]),
        ("crest_radius_mm = 10.5", "crest_radius_mm = 10.5\npitch_mm = 10.0", ["pitch_mm = 10", "leave one out"]),
        ("[5.0, 10.0, 15.0, 20.0]", "true", ["load.pressure_kpa = True", "list"]),
    ],
)
def test_wrong_scenes_are_refused(changed, old, new, said):
    with pytest.raises(SceneError) as refusal:
        load_bellows(changed(old, new))
    for words in said:
        assert words in str(refusal.value)


def test_what_is_measured_outside_and_a_single_pressure_are_taken(changed):
    outside = REFERENCE.replace("crest_radius_mm = 10.5", "outer_diameter_mm = 25.0")
    outside = outside.replace("half_pitch_mm = 5.0", "pitch_mm = 10.0")
    assert load_bellows(changed(REFERENCE, outside)) == load_bellows(changed("5", "5"))
    assert load_bellows(changed("[5.0, 10.0, 15.0, 20.0]", "20")).load.pressure_kpa == [20.0]
    assert load_bellows(changed("[5.0, 10.0, 15.0, 20.0]", "-1.5")).load.pressure_kpa == [-1.5]


def test_laws_are_refused_only_if_they_are_unstable_at_once(changed):
    material = REFERENCE[REFERENCE.index("law = ") : REFERENCE.index("[load]")]
    softening = changed(material, 'law = "yeoh"\nc_kpa = [36.0, -3.0, 0.1]\n\n')
    assert law_of(load_bellows(softening).material).initial_shear_modulus_mpa == pytest.approx(0.072)
    with pytest.raises(SceneError, match="material: Yeoh c_mpa C1 = -0.036"):
        load_bellows(changed(material, 'law = "yeoh"\nc_kpa = [-36.0, 3.0, 0.1]\n\n'))


def test_all_faults_are_reported_at_once(changed, tmp_path):
    path = changed("wall_mm = 2.0", "wal_mm = 2.0")
    path.write_text(path.read_text().replace("alpha = 5.836", "alpha = 'x'"), encoding="utf-8")
    with pytest.raises(SceneError) as refusal:
        load_bellows(path)
    assert "wal_mm" in str(refusal.value)
    assert "alpha" in str(refusal.value)


def test_units_of_the_law():
    scene = load_bellows(ROOT / "scenes" / "heung-t2-ri5.toml")
    # equation (3) of the paper: mu is the initial shear modulus, 75.449 kPa
    assert law_of(scene.material).initial_shear_modulus_mpa == pytest.approx(0.075449, rel=1e-12)
    assert inverse_kappa(scene.material) == 0.0


def test_adhesive_is_full_in_the_middle_of_a_seat_and_zero_at_its_edge(tmp_path):
    text = (ROOT / "scenes" / "heung-t2-ri5.toml").read_text(encoding="utf-8")
    path = tmp_path / "graded.toml"
    path.write_text(text.replace('bond = "rigid"', 'bond = "adhesive"'), encoding="utf-8")
    scene = load_bellows(path)
    middle = shape_of(scene).crest_positions_mm[3]
    grade = bond_grade(scene, middle + np.array([-2.5, -2.0, -1.5, 0.0, 1.0, 2.0]))
    assert grade == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("material", "tolerance", "model"),
    [
        ("pla", 1.0, "rigid"),
        ("pla", 0.05, "rigid"),  # 0.005 % is a tenth of it
        ("pla", 0.04, "meshed"),
        ("polyethylene", 0.4, "rigid"),
        ("polyethylene", 0.3, "meshed"),
    ],
)
def test_rings_are_meshed_only_where_the_tolerance_needs_it(tmp_path, material, tolerance, model):
    text = (ROOT / "scenes" / "heung-t2-ri5.toml").read_text(encoding="utf-8")
    text = text.replace('material = "pla"', f'material = "{material}"')
    path = tmp_path / "rings.toml"
    path.write_text(text.replace("tolerance_percent = 1.0", f"tolerance_percent = {tolerance}"), encoding="utf-8")
    assert load_bellows(path).rings.model == model


def test_a_zigzag_has_the_least_fillets_and_seats_and_the_same_dimensions() -> None:
    for moulded in sorted((ROOT / "scenes").glob("heung-t?-ri?.toml")):
        one, other = load_bellows(moulded), load_bellows(ROOT / "scenes" / "zigzag" / moulded.name)
        found, known = shape_of(other), shape_of(one)
        assert (found.fillet_mm, found.seat_mm) == (0.1, 0.5)
        assert replace(found, fillet_mm=known.fillet_mm, seat_mm=known.seat_mm) == known
        assert other.name == f"{one.name}-zigzag"


def test_sides_bend_at_points_of_ones_own(changed) -> None:
    scene = load_bellows(changed('profile = "arcs"', 'profile = "polyline"\npoints_mm = [[4.0, 9.0]]'))
    assert shape_of(scene).bends_mm == ((4.0, 9.0),)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ('profile = "zigzag"', "geometry.fillet_mm = 0.5: a zigzag has the least, 0.1 mm"),
        ('profile = "polyline"', "needs geometry.points_mm"),
        ("points_mm = [[4.0, 9.0]]", 'geometry.profile = "polyline"'),
        ('profile = "polyline"\npoints_mm = [[7.0, 9.0]]', r"points_mm = \[7, 9\]: a bend lies between crest and root"),
        ('profile = "polyline"\npoints_mm = [[-1.0, 9.0]]', "geometry.points_mm.0.0 = -1.0"),
        ('profile = "spline"', "allowed: 'arcs', 'zigzag' or 'polyline'"),
    ],
)
def test_a_profile_has_its_own_keys(changed, keys: str, said: str) -> None:
    with pytest.raises(SceneError, match=said):
        load_bellows(changed('profile = "arcs"', keys))
