"""What looks like another unit is told and nothing else; stretches beyond what is known of a law are told."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from studies.planning import warnings
from studies.planning.planner import describe, make_plan
from studies.planning.warnings import law_range, law_ranges, scene_warnings, stretch_warnings
from studies.scene.load import load_scene
from studies.scene.materials import NeoHookeMaterial, YeohMaterial

ROOT = Path(__file__).resolve().parents[3]
SCENES = sorted(path.relative_to(ROOT) for path in (ROOT / "scenes").rglob("*.toml"))
T1, SMALL = ROOT / "scenes" / "heung-t1-ri5.toml", ROOT / "scenes" / "exact"
PRESSURES, CONSTANTS = "pressure_kpa = [5.0, 10.0, 15.0, 20.0]", "c_kpa = [36.0, 2.5, 0.23]"


@pytest.mark.parametrize("path", SCENES, ids=str)
def test_shipped_scenes_give_no_warning(path: Path) -> None:
    assert scene_warnings(load_scene(ROOT / path)) == ()


def changed(tmp_path: Path, base: Path, *pairs: tuple[str, str]) -> Path:
    text = base.read_text(encoding="utf-8")
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    path = tmp_path / "changed.toml"
    path.write_text(text, encoding="utf-8")
    return path


RADII = ("inner_radius_mm = 5.0", "inner_radius_mm = 0.005"), ("outer_radius_mm = 7.0", "outer_radius_mm = 0.007")
INCHES = ("inner_radius_mm = 5.0", "inner_radius_mm = 0.2"), ("outer_radius_mm = 7.0", "outer_radius_mm = 0.28")
CASES = {
    "pressure in MPa": (T1, [(PRESSURES, "pressure_kpa = [0.005, 0.02]")], ["load.pressure_kpa", "0.02", "MPa"]),
    "vacuum in MPa": (T1, [(PRESSURES, "pressure_kpa = [-0.0002, -0.0004]")], ["load.pressure_kpa", "MPa"]),
    "constants in Pa": (T1, [(CONSTANTS, "c_kpa = [36000, 2500, 230]")], ["7.2e+04 kPa", "in Pa"]),
    "constants in MPa": (
        SMALL / "sphere-yeoh.toml",
        [(CONSTANTS, "c_kpa = [0.036, 0.0025, 0.00023]"), ("[10.0, 20.0, 30.0]", "[0.01, 0.02]")],
        ["0.072 kPa", "in MPa"],
    ),
    "cap in m": (T1, [("cap_mm = 5.0", "cap_mm = 0.005")], ["geometry.cap_mm = 0.005", "both in mm"]),
    "sphere in m": (SMALL / "sphere.toml", RADII, ["geometry.outer_radius_mm = 0.007", "metres or inches"]),
    "tube in inches": (SMALL / "tube.toml", INCHES, ["geometry.outer_radius_mm = 0.28", "metres or inches"]),
    "length in m": (
        SMALL / "tube.toml",
        [("length_mm = 2.0", "length_mm = 0.002")],
        ["geometry.length_mm = 0.002", "both in mm"],
    ),
    "wall in m": (
        SMALL / "tube.toml",
        [("outer_radius_mm = 7.0", "outer_radius_mm = 5.002")],
        ["outer_radius_mm less inner_radius_mm = 0.002", "both in mm"],
    ),
    "ring's pressure in MPa": (SMALL / "ring-2.toml", [("[0.2, 0.4, 0.5]", "[0.0002, 0.0005]")], ["in MPa"]),
    "tension in MPa": (SMALL / "cube.toml", [("[100.0, 180.0]", "[0.01, 0.018]")], ["load.tension_kpa", "in MPa"]),
    "traction in MPa": (SMALL / "cook.toml", [("[3125.0, 6250.0]", "[3.125, 6.25]")], ["load.traction_kpa", "in MPa"]),
    "edge in m": (SMALL / "cube.toml", [("edge_mm = 10.0", "edge_mm = 0.01")], ["geometry.edge_mm = 0.01", "metres"]),
    "degrees": (SMALL / "cylinder.toml", [("= 0.08 ", "= 0.9 ")], ["load.twist_rad_per_mm", "degrees"]),
    "mesh in inches": (
        SMALL / "mesh.toml",
        [('"octant.msh"', f'"{SMALL}/octant.msh"'), ("scale = 1.0", "scale = 0.1")],
        ["geometry.scale"],
    ),
    "mesh's pressure": (
        SMALL / "mesh.toml",
        [('"octant.msh"', f'"{SMALL}/octant.msh"'), ("[10.0, 20.0]", "[0.01, 0.02]")],
        ["load.pressure_kpa", "in MPa"],
    ),
    "kappa": (T1, [("kappa_over_mu = inf", "kappa_over_mu = 20.0")], ["kappa_over_mu = 20", "Poisson's ratio 0.4754"]),
    "kappa in Pa": (T1, [("kappa_over_mu = inf", "kappa_over_mu = 1.5e9")], ["kappa_over_mu = 1.5e+09", "ratio"]),
    "force in grams": (
        T1,
        [('tip = "cap" ', 'tip = "rigid" '), ("[load]", "[load]\ntip_force_n = 100.0")],
        ["load.tip_force_n = 100", "grams"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_mixed_up_units_are_told(name: str, tmp_path: Path) -> None:
    base, pairs, words = CASES[name]
    scene = load_scene(changed(tmp_path, base, *pairs))
    told = "\n".join(scene_warnings(scene))
    for word in words:
        assert word in told
    assert told in describe(scene, make_plan(scene)).replace("warning: ", "")


@pytest.mark.parametrize(
    ("function", "fine", "odd"),
    [
        (warnings.modulus_warnings, [(1.0,), (72.0,), (1e4,)], [(0.99,), (1.01e4,)]),
        (lambda p: warnings.load_warnings(p, 72.0, "k"), [(0.0721,), (1e3,)], [(0.0719,)]),
        (warnings.kappa_warnings, [(math.inf,), (100.0,), (1e5,)], [(50.0,), (1e7,)]),
        (lambda t: warnings.thickness_warnings(t, 10.0, "k"), [(0.05,), (1.0,)], [(0.01,)]),
        (warnings.twist_warnings, [(0.8,), (-6.2,)], [(6.3,), (-40.0,)]),
        (lambda f: warnings.force_warnings(f, 2.0), [(0.0,), (-1.0,), (5.0,)], [(-7.0,), (1e-5,)]),
    ],
)
def test_bounds(function, fine, odd) -> None:
    assert not any(function(*values) for values in fine)
    assert all(len(function(*values)) == 1 for values in odd)


def test_stretches_beyond_what_is_known(tmp_path: Path) -> None:
    ten = load_scene(T1)
    assert stretch_warnings(ten, [(10.0, 2.0), (20.0, 3.9)]) == []
    (unknown,) = stretch_warnings(ten, [(10.0, 2.0), (20.0, 4.2), (40.0, 6.0)])
    assert "the largest stretch is 4.2 at 20 kPa, to 6 at 40 kPa" in unknown and "unknown" in unknown
    assert unknown.endswith("Dragon Skin 10 breaks at 11")
    broken, also = stretch_warnings(ten, [(100.0, 11.5)])
    assert "Dragon Skin 10 breaks at 11 (elongation at break 1000 %" in broken
    assert "unknown" in also and "breaks" not in also
    thirty = load_scene(ROOT / "scenes" / "heung-t2-ri5.toml")
    assert "Dragon Skin 30 breaks at 4.64 (elongation at break 364 %" in stretch_warnings(thirty, [(60.0, 4.7)])[0]
    told = load_scene(changed(tmp_path, T1, (CONSTANTS, CONSTANTS + "\ndata_to_stretch = 5.0\n#")))
    (beyond,) = stretch_warnings(told, [(20.0, 4.9), (40.0, 5.5)])
    assert "5.5 at 40 kPa" in beyond and "which go to 5" in beyond
    assert stretch_warnings(told, [(20.0, 4.9)]) == []


def test_several_materials_are_told_by_their_keys() -> None:
    soft, layer = YeohMaterial(law="yeoh", c_kpa=[36.0, -3.0, 0.1]), NeoHookeMaterial(law="neo-hooke", mu_kpa=5e4)
    scene = load_scene(SMALL / "mesh.toml").model_copy(update={"materials": {"soft": soft, "layer": layer}})
    assert scene_warnings(scene) == ()  # a stiff layer is none of another unit
    (text,) = law_ranges(scene)
    assert text.startswith("law: materials.soft is stable up to stretch 2.4 (uniaxial), 1.71 (equib")
    told = stretch_warnings(scene, [(10.0, 4.2)])
    assert [t.rpartition("; ")[2] for t in told] == [
        f"if it is in {k}" for k in ("material", "materials.soft", "materials.layer")
    ]


def test_range_of_a_law_is_told_only_where_there_is_one() -> None:
    assert law_range(NeoHookeMaterial(law="neo-hooke", mu_kpa=72.0)) == ""
    text = law_range(YeohMaterial(law="yeoh", c_kpa=[22.2115, 2.6603, -0.0735]))
    assert text.startswith("law: stable up to stretch 4.49 (uniaxial), 3.19 (equibiaxial), 4.41 (pure shear)")
