"""Exact thick-walled tube (plane strain) and sphere of concentric layers under pressure, each layer with its own law.

Incompressibility makes the deformation one map for all layers, r^2 = a^2 + R^2 - A^2 of a tube, r^3 = a^3 + R^3 - A^3
of a sphere, so that the deformed inner radius a fixes it. The radial stress and the displacement are continuous, so
the pressures that the layers carry add up,

    P(a) = sum over layers of the pressure of the layer alone with its inner radius at r(A_layer).

Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from analytical.exact import sphere, tube
from analytical.exact.search import STRETCH_RANGE, first_solution
from analytical.laws.isotropic import IsotropicLaw


class LayersError(ValueError):
    """Layers that cannot exist, or a pressure they cannot carry; the message names value and remedy."""


@dataclass(frozen=True)
class Layers:
    """An undeformed body of concentric layers.

    Parameters
    ----------
    kind
        ``tube`` in plane strain, or ``sphere``.
    radii_mm
        Undeformed radii of the surfaces, ascending from the bore outwards, one more than layers, mm.
    laws
        The layers' laws from the bore outwards.
    """

    kind: Literal["tube", "sphere"]
    radii_mm: tuple[float, ...]
    laws: tuple[IsotropicLaw, ...]

    def __post_init__(self) -> None:
        ascending = all(a < b for a, b in zip(self.radii_mm[:-1], self.radii_mm[1:], strict=True))
        if len(self.radii_mm) != len(self.laws) + 1 or not ascending:
            raise LayersError(f"radii {self.radii_mm} mm of {len(self.laws)} layers: need one more, ascending")


def deformed_radius_mm(body: Layers, inner_mm: float, radius_mm: float) -> float:
    """Deformed radius of the particles at an undeformed one, mm."""
    power = 2 if body.kind == "tube" else 3
    return float((inner_mm**power + radius_mm**power - body.radii_mm[0] ** power) ** (1.0 / power))


def layer_pressures_mpa(body: Layers, inner_mm: float) -> list[float]:
    """Fall of the pressure across each layer with the inner radius at a, from the bore outwards, MPa."""
    out = []
    for low, high, law in zip(body.radii_mm[:-1], body.radii_mm[1:], body.laws, strict=True):
        at = deformed_radius_mm(body, inner_mm, low)
        if body.kind == "tube":
            out.append(tube.pressure_at_inner_radius_mpa(tube.Tube(low, high), law, at))
        else:
            out.append(sphere.pressure_at_inner_radius_mpa(sphere.Sphere(low, high), law, at))
    return out


def hydrostatic_pressure_mpa(body: Layers, inner_mm: float, radii_mm: Sequence[float], layer: int) -> list[float]:
    """Hydrostatic pressure -tr(sigma)/3 at undeformed radii within a layer (counted from the bore), MPa."""
    low, high = body.radii_mm[layer : layer + 2]
    law, at = body.laws[layer], deformed_radius_mm(body, inner_mm, low)
    outside = sum(layer_pressures_mpa(body, inner_mm)[layer + 1 :])
    if body.kind == "tube":
        alone = [float(tube.hydrostatic_pressure_mpa(tube.Tube(low, high), law, at, r)) for r in radii_mm]
    else:
        alone = [float(sphere.hydrostatic_pressure_mpa(sphere.Sphere(low, high), law, at, r)) for r in radii_mm]
    return [outside + one for one in alone]


def inner_radius_at_pressure_mm(body: Layers, pressure_mpa: float) -> float:
    """Deformed inner radius at a pressure, inside minus outside: the first met from rest, mm.

    Raises
    ------
    LayersError
        If no inner stretch within `STRETCH_RANGE` carries it.
    """
    start = body.radii_mm[0]
    if not math.isfinite(pressure_mpa):
        raise LayersError(f"pressure = {pressure_mpa} MPa is not a finite number")
    bounds = (STRETCH_RANGE[0] * start, STRETCH_RANGE[1] * start)
    root, _ = first_solution(lambda a: sum(layer_pressures_mpa(body, a)), start, bounds, pressure_mpa)
    if root is None:
        raise LayersError(f"pressure {pressure_mpa:g} MPa is more than the layers carry: take less")
    return root
