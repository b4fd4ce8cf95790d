"""Crossings of harmonics against the inertia of the whole body in 3D: the same counts on both sides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.stability.modes import ModeCounter
from solvers.state import State
from studies.models.build import revolve_state
from studies.models.modes import FoundCrossing, read_shape
from studies.models.modes_model import ModesModel
from studies.results.rows import REACHED, Row, row
from studies.scene.meshes import revolved

# Counts are compared this share below and above the crossing: if both agree, so do the loads, within this share.
BAND = 0.005
# Cells round: the body of scenes/modes/blocked-short.toml gives way 0.5 to 1 % sooner on 8, 0.2 to 0.5 % on 12.
AROUND = 16


def on_full_circle(counts: Sequence[int]) -> int:
    """Unstable modes of the body of revolution from those of m = 0, 1, ...: m >= 1 come in pairs."""
    return counts[0] + 2 * sum(counts[1:])


def confirm_rows(model: ModesModel, folder: Path, crossing: FoundCrossing, around: int = AROUND) -> list[Row]:
    """Unstable modes of the body below and above a crossing, beside the harmonics' count.

    Parameters
    ----------
    model
        The scene.
    folder
        Of the counted run on the coarsest meridian, which the body is made from.
    crossing
        One of that run.
    around
        Cells round the circumference.

    Returns
    -------
    list of Row
        ``unstable_modes`` at the two pressures; the reference is the harmonics' count over the whole circle.
    """
    meridian = model.meridian(1)
    body = revolved(meridian, around)
    flat, solid = model.problem(1), model.body_problem(body)
    flat_factor, solid_factor, counter = Factor(flat), Factor(solid), ModeCounter(flat)
    start, _ = read_shape(folder, crossing.waves)
    number = partial(row, model.scene.name, "unstable_modes", "1", model="full3d", level=f"n{around}")
    rows = []
    for share in (1.0 - BAND, 1.0 + BAND):
        pressure = 1e-3 * crossing.pressure_kpa * share
        value, status, expected = math.nan, REACHED, math.nan
        try:
            here = _at_pressure(flat, flat_factor, start, pressure)
            expected = float(on_full_circle(counter.counts(here)))
            solid.set_state(revolve_state(here, meridian, body))
            report = solve_equilibrium(solid, solid_factor, NewtonSettings(), HeldLoad(pressure))
            value = math.nan if report.excess_negatives is None else float(report.excess_negatives)
        except (StepFailed, SolverError) as error:
            status = f"stopped at {1e3 * pressure:.6g} kPa: {error}"
        kpa, source = 1e3 * pressure, "harmonics m = 0…6, r1, m ≥ 1 twice"
        rows.append(number(pressure_kpa=kpa, value=value, reference=expected, source=source, status=status))
    for factor in (flat_factor, solid_factor):
        factor.close()
    counter.close()
    return rows


def _at_pressure(problem: Problem, factor: Factor, start: State, pressure_mpa: float) -> State:
    problem.set_state(start)
    solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(pressure_mpa))
    return problem.get_state()
