"""Replaced assumptions against other routes: the exact tube with free ends, the uniaxial test, the plate's equation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDesigns, BellowsError
from analytical.bellows.paper import PaperActuator
from analytical.bellows.validity import (
    cap_bulge_mm,
    free_root_stretch,
    mid_wall_hoop_stretch,
    with_free_root,
    with_other_wall,
)
from analytical.exact.homogeneous import stretch_at_stress
from analytical.exact.tube import Tube, deformed_radius_mm, state_at_pressure
from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.bellows.cases import ACTUATORS, every_actuator
from tests.analytical.cases import each_of_three_laws

PRESSURES_KPA = np.array([0.0, 2.0, 8.0, 20.0])


@each_of_three_laws
@pytest.mark.parametrize("ratio", [1.1, 1.4, 3.0])
@pytest.mark.parametrize("pressure_mpa", [1e-3, 0.01, 0.02])
def test_free_root_is_the_exact_tube_with_free_ends(law: Law, ratio: float, pressure_mpa: float) -> None:
    hoop, axial = free_root_stretch(ratio, law, pressure_mpa)
    state = state_at_pressure(Tube(1.0, ratio), law, pressure_mpa, "free")
    # two quadratures and two root finders; 1e-10 is what both are asked for
    outer = float(deformed_radius_mm(state.tube, state.inner_mm, ratio)) / ratio
    assert float(hoop) == pytest.approx(outer, rel=1e-10)
    assert float(axial) == pytest.approx(state.tube.axial_stretch, rel=1e-10)


def test_free_root_is_found_from_afar() -> None:
    near, far = (free_root_stretch(1.3, DRAGON_SKIN_10, 0.02, guess)[0] for guess in (1.4, 2.5))
    assert math.isclose(float(near), float(far), rel_tol=1e-13)  # round-off


@every_actuator
def test_free_root_is_held_at_full_unfolding_and_keeps_the_wall(actuator: PaperActuator) -> None:
    path = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA)
    free = with_free_root(path)
    # round-off: the limit is the same quotient
    assert np.all(free.root_stretch <= actuator.dimensions.unfolded_root_stretch * (1.0 + 1e-15))
    assert np.all((free.drop_mm == 0.0) == (free.state == "fully unfolded"))
    assert np.array_equal(free.wall_stretch, path.wall_stretch)
    assert free.elongation_mm[0] == pytest.approx(0.0, abs=1e-12)  # at rest, mm; round-off


@every_actuator
def test_uniaxial_wall_is_the_tensile_test_at_its_stress(actuator: PaperActuator) -> None:
    path = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA)
    other = with_other_wall(path, "uniaxial")
    for stress, stretch in zip(path.wall_stress_mpa, other.wall_stretch, strict=True):
        # round-off of the stress over its slope, through two root finders
        assert stretch == pytest.approx(stretch_at_stress(actuator.law, "uniaxial", float(stress), "cauchy"), rel=1e-12)
    assert np.array_equal(other.root_stretch, path.root_stretch)


@every_actuator
def test_small_strains_have_hookes_ratios(actuator: PaperActuator) -> None:
    path = closed_form(actuator.dimensions, actuator.law, 1e-4)
    strain = path.wall_stretch - 1.0
    # E = 3 mu in uniaxial tension, 4 mu in plane strain; the next term of the expansion is of the strain's size, 2e-6,
    # and round-off of a stretch is 1e-10 of such a strain
    assert with_other_wall(path, "uniaxial").wall_stretch - 1.0 == pytest.approx(4.0 / 3.0 * strain, rel=1e-4)
    # sigma = 4 mu (strain along + hoop strain / 2): a hoop strain takes half of itself from the strain along the wall
    hoop = mid_wall_hoop_stretch(path) - 1.0
    other = with_other_wall(path, "stretched by the root").wall_stretch - 1.0
    assert other == pytest.approx(strain - 0.5 * hoop, rel=1e-4)


def test_wall_without_hoop_stretch_is_in_pure_shear() -> None:
    path = closed_form(ACTUATORS[0].dimensions, ACTUATORS[0].law, PRESSURES_KPA)
    unstretched = replace(path, root_stretch=np.ones(len(PRESSURES_KPA)))
    assert mid_wall_hoop_stretch(unstretched) == pytest.approx(np.ones(len(PRESSURES_KPA)), rel=1e-15)
    other = with_other_wall(unstretched, "stretched by the root")
    # round-off of the stress over its slope
    assert other.wall_stretch == pytest.approx(path.wall_stretch, rel=1e-13)


def test_wall_under_its_stress_and_the_roots_hoop_stretch() -> None:
    actuator = ACTUATORS[0]
    path = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA)
    stretch = with_other_wall(path, "stretched by the root").wall_stretch
    d = actuator.dimensions
    # outer surface half way between root and crest
    radius = 0.5 * (d.root_radius_mm + d.crest_radius_mm) + d.wall_mm
    moved = 0.5 * (path.root_stretch * (d.root_radius_mm + d.wall_mm) + d.crest_radius_mm + d.wall_mm)
    hoop = moved / radius
    stress = actuator.law.stress_difference(stretch, 1.0 / (stretch * hoop), hoop)
    assert stress == pytest.approx(path.wall_stress_mpa, rel=1e-13, abs=1e-16)  # round-off


def test_many_designs_at_once_are_the_designs_one_by_one() -> None:
    ds = [actuator.dimensions for actuator in ACTUATORS]
    many = BellowsDesigns(*(np.array([getattr(d, name) for d in ds]) for name in vars(ds[0])))
    path = closed_form(many, DRAGON_SKIN_10, PRESSURES_KPA)
    for change in (with_free_root, lambda p: with_other_wall(p, "stretched by the root")):
        together = change(path).elongation_mm
        assert together.shape == (4, len(PRESSURES_KPA))
        for k, d in enumerate(ds):
            alone = change(closed_form(d, DRAGON_SKIN_10, PRESSURES_KPA)).elongation_mm
            # other numbers of quadrature points and of Newton steps: round-off of 100 mm
            assert together[k] == pytest.approx(alone, abs=1e-11)


def test_cap_bulge_solves_the_plates_equations() -> None:
    # D lap lap w = P for w = w0 (1 - (r/R)^2)^2, which is clamped; the Laplacian of r^k is k^2 r^(k-2)
    shape = {0: 1.0, 2: -2.0, 4: 1.0}
    for _ in range(2):
        shape = {power - 2: power**2 * factor for power, factor in shape.items() if power}
    assert list(shape) == [0]
    law, radius, pressure_kpa, thicknesses = DRAGON_SKIN_10, 10.0, 2.0, np.array([0.1, 5.0])
    mu = law.initial_shear_modulus_mpa
    rigidity = 3.0 * mu * thicknesses**3 / (12.0 * (1.0 - 0.5**2))  # E h^3 / (12 (1 - nu^2))
    bending = 1e-3 * pressure_kpa * radius**4 / (shape[0] * rigidity)
    # k mu h lap w = -P for w = w0 (1 - (r/R)^2)
    shear = 1e-3 * pressure_kpa * radius**2 / (4.0 * (5.0 / 6.0) * mu * thicknesses)
    # round-off
    assert cap_bulge_mm(radius, thicknesses, law, pressure_kpa) == pytest.approx(bending + shear, rel=1e-14)


def test_bad_input_is_refused() -> None:
    path = closed_form(ACTUATORS[0].dimensions, ACTUATORS[0].law, 20.0)
    with pytest.raises(BellowsError, match="wall = 'biaxial' is unknown"):
        with_other_wall(path, "biaxial")  # type: ignore[arg-type]
    with pytest.raises(BellowsError, match="does not reach the wall stress"):
        with_other_wall(replace(path, wall_stretch=np.array([1e6])), "uniaxial")
    with pytest.raises(BellowsError, match=r"free of axial force found up to 1e\+06 kPa"):
        free_root_stretch(1.2, NeoHooke(0.1), 1e3)
