"""The three chains: printed numbers, an independent second route, balances, arrays of designs."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest

from analytical.bellows.chains import closed_form, closed_form_balanced, closed_form_printed, validity_warnings
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions, BellowsError, silicone_mass_g, with_seat
from analytical.bellows.paper import PaperActuator
from analytical.bellows.reading import Cut, Reading
from analytical.laws.isotropic import OGDEN_CONVENTIONS, NeoHooke, OgdenConvention, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from tests.analytical.bellows.by_equations import elongation_by_equations_cm
from tests.analytical.bellows.cases import ACTUATORS, every_actuator


def elongation_cm(actuator: PaperActuator, pressure_kpa: float = 20.0) -> float:
    return 0.1 * float(closed_form(actuator.dimensions, actuator.law, pressure_kpa).elongation_mm[0])


@every_actuator
def test_printed_column_within_5_percent(actuator: PaperActuator) -> None:
    # The rule of the dimension study: the dimensions are inferred from this column, whose last digit is
    # itself worth 0.4 to 1.3 %.
    assert elongation_cm(actuator) == pytest.approx(actuator.printed.closed_form_cm, rel=0.05)


@every_actuator
@pytest.mark.parametrize("pressure_kpa", [1.0, 8.0, 20.0])
def test_same_as_the_equations(actuator: PaperActuator, pressure_kpa: float) -> None:
    by_equations = elongation_by_equations_cm(actuator, 1e-3 * pressure_kpa)
    # two routes through different quadratures and root finders; 1e-10 is what both are asked for
    assert elongation_cm(actuator, pressure_kpa) == pytest.approx(by_equations, rel=1e-10)


def test_first_actuator_known_numbers() -> None:
    # three digits are known of each
    assert elongation_cm(ACTUATORS[0]) == pytest.approx(11.7, abs=0.05)
    assert elongation_by_equations_cm(ACTUATORS[0], wall_stress_on_deformed_area=True) == pytest.approx(16.3, abs=0.05)


@pytest.mark.parametrize(("index", "known_kpa"), [(0, 18.1), (1, 8.4)])
def test_unfolding_pressures_of_the_thin_pair(index: int, known_kpa: float) -> None:
    actuator = ACTUATORS[index]
    path = closed_form(actuator.dimensions, actuator.law, 20.0)
    # three and two digits are known; the linearised eq. (14) would give 19.4 and 8.75
    assert path.unfolding_pressure_kpa[0] == pytest.approx(known_kpa, abs=0.05)
    assert list(path.state) == ["fully unfolded"]


def test_fold_back_of_the_print() -> None:
    # 0.56 cm is known for the second actuator from eq. (14) as printed, without saturation
    assert elongation_by_equations_cm(ACTUATORS[1], linearised=True, saturated=False) == pytest.approx(0.56, abs=0.005)


@every_actuator
@pytest.mark.parametrize("pressure_kpa", [2.0, 8.0, 20.0])
def test_printed_chain_by_the_equations(actuator: PaperActuator, pressure_kpa: float) -> None:
    by_equations = elongation_by_equations_cm(
        actuator,
        1e-3 * pressure_kpa,
        linearised=True,
        ogden_derivative=True,
        ogden_wall_by_20=True,
        saturated=False,
        table=True,
    )
    path = closed_form_printed(actuator.dimensions, actuator.law, pressure_kpa)
    # two routes, 1e-10 asked of both; lengths of up to 10 cm
    assert 0.1 * path.elongation_mm == pytest.approx([by_equations], abs=1e-9)


@pytest.mark.parametrize("convention", OGDEN_CONVENTIONS)
def test_printed_chain_ignores_the_convention(convention: OgdenConvention) -> None:
    dimensions = ACTUATORS[2].dimensions
    printed = closed_form_printed(dimensions, dragon_skin_30(convention), [5.0, 20.0]).elongation_mm
    known = closed_form_printed(dimensions, dragon_skin_30("mu/alpha"), [5.0, 20.0]).elongation_mm
    # the same numbers mu and alpha in the same formulas; the first guess differs
    assert printed == pytest.approx(known, rel=1e-13)


@every_actuator
@pytest.mark.parametrize("pressure_kpa", [1.0, 8.0, 20.0])
def test_balanced_chain_is_the_virtual_work_of_its_motion(actuator: PaperActuator, pressure_kpa: float) -> None:
    d, law = actuator.dimensions, actuator.law
    path = closed_form_balanced(d, law, pressure_kpa)
    drop, half_pitch = float(path.drop_mm[0]), float(path.half_pitch_deformed_mm[0])
    bore = d.root_radius_mm * float(path.root_inner_stretch[0])
    wall_volume = math.pi * d.wall_mm * (d.root_radius_mm + d.crest_radius_mm + d.wall_mm) * d.side_length_mm

    def energy(a: float) -> float:
        stretch = math.hypot(a, drop) / d.side_length_mm
        stored = wall_volume * float(law.energy(stretch, 1.0, 1.0 / stretch))
        enclosed = math.pi * a * (d.crest_radius_mm**2 + d.crest_radius_mm * bore + bore**2) / 3.0
        return stored - 1e-3 * pressure_kpa * enclosed

    h = 1e-3 * half_pitch
    force = (
        8.0 * (energy(half_pitch + h) - energy(half_pitch - h))
        - energy(half_pitch + 2 * h)
        + energy(half_pitch - 2 * h)
    ) / (12.0 * h)
    # truncation h^4 of the difference, relative to the thrust
    assert force == pytest.approx(0.0, abs=1e-9 * float(path.extension_force_n[0]))


@pytest.mark.parametrize("cut", get_args(Cut))
@pytest.mark.parametrize("on_deformed_area", [False, True])
@pytest.mark.parametrize("along_axis", [False, True])
@every_actuator
def test_forces_balance(actuator: PaperActuator, cut: Cut, on_deformed_area: bool, along_axis: bool) -> None:
    reading = Reading(cut=cut, wall_on_deformed_area=on_deformed_area, wall_along_axis=along_axis)
    path = closed_form(actuator.dimensions, actuator.law, [3.0, 11.0, 20.0], reading)
    # Newton's last increment squared is far below this
    assert path.resistive_force_n == pytest.approx(path.extension_force_n, rel=1e-12)


def test_many_designs_at_once() -> None:
    pressures = [0.0, 4.0, 12.0, 25.0]
    roots, walls = np.array([4.0, 5.0, 7.0])[:, None], np.array([0.5, 1.0, 2.0])
    designs = BellowsDesigns(roots, 10.5, walls, 5.0, np.array([3, 8, 12]))
    assert designs.shape == (3, 3)
    for chain in (closed_form, closed_form_printed, closed_form_balanced):
        for law in (DRAGON_SKIN_10, dragon_skin_30("2mu/alpha^2")):
            many = chain(designs, law, pressures)
            assert many.elongation_mm.shape == (3, 3, 4)
            for i in range(3):
                for j in range(3):
                    n = (3, 8, 12)[j]
                    one = chain(BellowsDimensions(float(roots[i, 0]), 10.5, float(walls[j]), 5.0, n), law, pressures)
                    # other numbers of Gauss points and iterations: round-off
                    assert many.elongation_mm[i, j] == pytest.approx(
                        one.elongation_mm, rel=1e-11, abs=1e-11, nan_ok=True
                    )
                    assert list(many.state[i, j]) == list(one.state)
                    assert many.unfolding_pressure_kpa[i, j] == pytest.approx(one.unfolding_pressure_kpa, rel=1e-13)


def test_state_and_warnings() -> None:
    thin = ACTUATORS[1]
    corrected = closed_form(thin.dimensions, thin.law, [5.0, 20.0])
    assert list(corrected.state) == ["folded", "fully unfolded"]
    none, rests = validity_warnings(corrected, 11.0)
    assert none == ()
    assert len(rests) == 1 and "fully unfolded from 8.4 kPa" in rests[0]
    printed = closed_form_printed(thin.dimensions, thin.law, [5.0, 20.0])
    assert list(printed.state) == ["folded", "past the model"]
    assert "folds back" in validity_warnings(printed, 11.0)[1][0]
    assert "breaks at 1.2" in validity_warnings(corrected, 1.2)[1][1]
    # beyond the wall's length eq. (23) has no real root
    assert np.isnan(closed_form_printed(thin.dimensions, thin.law, 60.0).elongation_mm[0])
    assert list(closed_form_printed(thin.dimensions, thin.law, 60.0).state) == ["past the model"]


@every_actuator
def test_zero_at_zero_pressure(actuator: PaperActuator) -> None:
    path = closed_form(actuator.dimensions, actuator.law, 0.0)
    # a pressure below round-off, as differences of decimal fractions leave it, must not break the root finder
    assert list(closed_form(actuator.dimensions, actuator.law, 5e-17).state) == ["folded"]
    # round-off of a length of a few mm, times 16
    assert path.elongation_mm == pytest.approx([0.0], abs=1e-12)
    assert path.root_stretch == pytest.approx([1.0], abs=0.0)
    assert path.wall_stretch == pytest.approx([1.0], abs=0.0)
    assert list(path.state) == ["folded"]
    d = actuator.dimensions
    rest_rad = math.atan2(d.crest_radius_mm - d.root_radius_mm, d.half_pitch_mm)
    assert path.angle_rad == pytest.approx([rest_rad], rel=1e-14)


@every_actuator
def test_monotone(actuator: PaperActuator) -> None:
    path = closed_form(actuator.dimensions, actuator.law, np.linspace(0.0, 40.0, 81))
    assert np.all(np.diff(path.elongation_mm) > 0.0)
    assert np.all(np.diff(path.wall_stretch) > 0.0)
    assert np.all(np.diff(path.root_stretch) >= 0.0)
    assert np.all(np.diff(path.angle_rad) <= 0.0)
    assert np.all(path.root_inner_stretch >= path.root_stretch)


def test_saturation() -> None:
    actuator = ACTUATORS[1]
    d = actuator.dimensions
    unfolding = float(closed_form(d, actuator.law, 0.0).unfolding_pressure_kpa[0])
    path = closed_form(d, actuator.law, [unfolding * (1.0 - 1e-6), unfolding * (1.0 + 1e-6), 30.0])
    assert list(path.state) == ["folded", "fully unfolded", "fully unfolded"]
    assert path.root_stretch[1:] == pytest.approx([11.5 / 8.0] * 2, rel=1e-15)
    assert path.angle_rad[1:] == pytest.approx([0.0, 0.0], abs=0.0)
    assert path.half_pitch_deformed_mm[1:] == pytest.approx(path.side_length_deformed_mm[1:], rel=1e-15)
    # continuous: across 2e-6 of the pressure the side wall lengthens by about 1e-6
    assert path.elongation_mm[1] == pytest.approx(path.elongation_mm[0], rel=1e-5)


def test_similarity() -> None:
    # Lengths times 3, moduli and pressure times 2: 3 times the elongation, to the root finders' 1e-14.
    small = BellowsDimensions(5.0, 10.5, 1.0, 5.0, 8)
    large = BellowsDimensions(15.0, 31.5, 3.0, 15.0, 8)
    soft, hard = Yeoh((0.036, 0.0025)), Yeoh((0.072, 0.005))
    one = closed_form(small, soft, [5.0, 15.0]).elongation_mm
    other = closed_form(large, hard, [10.0, 30.0]).elongation_mm
    assert other == pytest.approx(3.0 * one, rel=1e-12)


def test_seat_takes_axial_room() -> None:
    actuator = ACTUATORS[0]
    free = with_seat(actuator.dimensions, 4.0)
    assert free.half_pitch_mm == 3.0
    assert free.side_length_mm == pytest.approx(math.hypot(3.0, 5.5), rel=1e-15)
    assert with_seat(actuator.dimensions, 0.0) == actuator.dimensions
    path = closed_form(free, actuator.law, [0.0, 20.0])
    # unfolded at 20 kPa, so the elongation is known without the root
    unfolded = 2.0 * 8 * (path.wall_stretch[1] * math.hypot(3.0, 5.5) - 3.0)
    assert path.elongation_mm == pytest.approx([0.0, unfolded], rel=1e-13, abs=1e-12)


def test_bad_input_is_refused() -> None:
    good = ACTUATORS[0].dimensions
    with pytest.raises(BellowsError, match="wall_mm"):
        BellowsDimensions(5.0, 10.5, 0.0, 5.0, 8)
    with pytest.raises(BellowsError, match="half_pitch_mm"):
        BellowsDimensions(5.0, 10.5, 1.0, math.nan, 8)
    with pytest.raises(BellowsError, match="crest_radius_mm"):
        BellowsDimensions(5.0, 5.0, 1.0, 5.0, 8)
    with pytest.raises(BellowsError, match="convolutions"):
        BellowsDimensions(5.0, 10.5, 1.0, 5.0, 0)
    with pytest.raises(BellowsError, match="convolutions"):
        BellowsDimensions(5.0, 10.5, 1.0, 5.0, math.nan)  # type: ignore[arg-type]
    for seat_mm in (-1.0, 10.0, math.nan):
        with pytest.raises(BellowsError, match="seat_mm"):
            with_seat(good, seat_mm)
    for pressure_kpa in (-1.0, math.nan, math.inf):
        with pytest.raises(BellowsError, match="pressure_kpa"):
            closed_form(good, DRAGON_SKIN_10, pressure_kpa)
    # a law whose wall stress tends to zero cannot balance the thrust
    with pytest.raises(BellowsError, match="does not reach the wall stress"):
        closed_form(good, Yeoh((0.036, -0.003)), 100.0)


def test_wall_stress_is_carried_by_the_law() -> None:
    law = NeoHooke(0.1)
    path = closed_form(ACTUATORS[0].dimensions, law, [5.0, 10.0])
    assert path.wall_stress_mpa == pytest.approx(np.array([5e-3, 10e-3]) * 10.5**2 / 11.0, rel=1e-14)
    # the root finder's tolerance
    assert law.mu_mpa * (path.wall_stretch**2 - path.wall_stretch**-2) == pytest.approx(path.wall_stress_mpa, rel=1e-13)


def test_mass_by_pappus() -> None:
    d = BellowsDimensions(5.0, 10.5, 1.0, 5.0, 8)
    length = math.hypot(5.0, 5.5)
    # the middle of the wall lies t/2 off the cavity side, along the normal
    middle = 0.5 * (5.0 + 10.5) + 0.5 * 1.0 * (5.0 / length)
    assert silicone_mass_g(d, 1.07) == pytest.approx(16 * 2.0 * math.pi * middle * length * 1.0 * 1.07e-3, rel=1e-14)
