"""Tubes and spheres of layers: one law split in two is one body, work of the pressure is stored, what is refused."""

from __future__ import annotations

import math

import pytest

from analytical.exact import sphere, tube
from analytical.exact.layers import (
    Layers,
    LayersError,
    deformed_radius_mm,
    hydrostatic_pressure_mpa,
    inner_radius_at_pressure_mm,
    layer_pressures_mpa,
)
from analytical.laws.isotropic import NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from tests.analytical.cases import derivative

OGDEN = dragon_skin_30("2mu/alpha^2")
RADII = (4.0, 4.7, 6.0)
TUBE = Layers("tube", RADII, (DRAGON_SKIN_10, OGDEN))
SPHERE = Layers("sphere", RADII, (DRAGON_SKIN_10, OGDEN))


def test_layers_of_one_law_are_one_body() -> None:
    bore, at = 5.5, [4.1, 4.6]
    one_tube, one_sphere = tube.Tube(4.0, 6.0), sphere.Sphere(4.0, 6.0)
    two = Layers("tube", RADII, (OGDEN, OGDEN))
    assert sum(layer_pressures_mpa(two, bore)) == pytest.approx(
        tube.pressure_at_inner_radius_mpa(one_tube, OGDEN, bore), rel=1e-12
    )
    assert hydrostatic_pressure_mpa(two, bore, at, 0) == pytest.approx(
        list(tube.hydrostatic_pressure_mpa(one_tube, OGDEN, bore, at)), rel=1e-11
    )
    two = Layers("sphere", RADII, (OGDEN, OGDEN))
    assert sum(layer_pressures_mpa(two, bore)) == pytest.approx(
        sphere.pressure_at_inner_radius_mpa(one_sphere, OGDEN, bore), rel=1e-12
    )
    assert hydrostatic_pressure_mpa(two, bore, [5.0, 5.9], 1) == pytest.approx(
        list(sphere.hydrostatic_pressure_mpa(one_sphere, OGDEN, bore, [5.0, 5.9])), rel=1e-11
    )


@pytest.mark.parametrize("body", [TUBE, SPHERE], ids=["tube", "sphere"])
def test_pressure_is_the_derivative_of_the_stored_energy_by_the_volume(body: Layers) -> None:
    def stored(inner_mm: float) -> float:
        total = 0.0
        for low, high, law in zip(RADII[:-1], RADII[1:], body.laws, strict=True):
            at = deformed_radius_mm(body, inner_mm, low)
            if body.kind == "tube":
                total += tube.stored_energy_n(tube.Tube(low, high), law, at)
            else:
                total += sphere.stored_energy_mj(sphere.Sphere(low, high), law, at)
        return total

    area = 2.0 * math.pi * 5.5 if body.kind == "tube" else 4.0 * math.pi * 5.5**2
    assert sum(layer_pressures_mpa(body, 5.5)) == pytest.approx(derivative(stored, 5.5) / area, rel=1e-8)


@pytest.mark.parametrize("body", [TUBE, SPHERE], ids=["tube", "sphere"])
def test_bore_at_a_pressure_has_it(body: Layers) -> None:
    bore = inner_radius_at_pressure_mm(body, 0.012)
    assert bore > 4.0
    assert sum(layer_pressures_mpa(body, bore)) == pytest.approx(0.012, rel=1e-10)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(LayersError, match="of 1 layers: need one more, ascending"):
        Layers("tube", RADII, (OGDEN,))
    with pytest.raises(LayersError, match="more than the layers carry"):
        inner_radius_at_pressure_mm(Layers("sphere", (4.0, 5.0), (NeoHooke(0.03),)), 1.0)
