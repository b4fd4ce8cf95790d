"""What is known of a round body: its bore, the pressure in its wall, and how far it can be loaded."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from analytical.exact import compressible, sphere, tube
from analytical.exact.sphere import Sphere
from analytical.exact.tube import Tube
from meshes.solid import FloatArray
from studies.stability.cells import Round

# Bore that exact answers are looked for up to, as a multiple of the undeformed one.
_LARGEST_STRETCH = 50.0


@dataclass(frozen=True)
class Answer:
    """The exact state of a round body.

    Attributes
    ----------
    bore_mm
        Radial displacement of the bore; NaN if the load is beyond what the body carries.
    multiplier_mpa
        tr(sigma)/3 as a function of undeformed radii, for a free outer surface; None with ``bore_mm`` NaN.
    reachable_mpa
        The load itself, or if that is beyond what the body carries the largest that it does.
    """

    bore_mm: float
    multiplier_mpa: Callable[[FloatArray], FloatArray] | None
    reachable_mpa: float


def exact_answer(body: Round, load_mpa: float) -> Answer:
    """The state under a pressure from inside (negative: a vacuum), the first met from rest."""
    inner, outer, law = body.inner_mm, body.inner_mm + body.wall_mm, body.law
    shape: Tube | Sphere = Tube(inner, outer) if body.kind == "tube" else Sphere(inner, outer)
    if math.isfinite(body.kappa_over_mu):
        kappa = body.kappa_over_mu * law.initial_shear_modulus_mpa
        state = compressible.state_at_pressure(shape, law, kappa, load_mpa)
        return Answer(
            state.inner_mm - inner, lambda radius: -compressible.hydrostatic_pressure_mpa(state, radius), load_mpa
        )
    if isinstance(shape, Tube):
        pressure = partial(tube.pressure_at_inner_radius_mpa, shape, law)
        hydrostatic = partial(tube.hydrostatic_pressure_mpa, shape, law)
    else:
        pressure = partial(sphere.pressure_at_inner_radius_mpa, shape, law)
        hydrostatic = partial(sphere.hydrostatic_pressure_mpa, shape, law)
    bounds = (inner / _LARGEST_STRETCH, _LARGEST_STRETCH * inner)
    bore, furthest = tube.first_solution(pressure, inner, bounds, load_mpa)
    if bore is None:
        return Answer(math.nan, None, furthest)
    found = bore
    return Answer(bore - inner, lambda radius: -hydrostatic(found, radius), load_mpa)
