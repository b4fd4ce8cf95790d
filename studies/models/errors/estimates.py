"""Discretisation errors of the states of an axisymmetric run, with a sign, from its own mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from mpi4py import MPI

from solvers.errors import StepFailed
from solvers.estimate.enriched import Enriched
from solvers.problem import Problem
from solvers.state import State
from studies.models.body_problem import body_of, measures, problem_of
from studies.models.build import Tip, scene_problem
from studies.planning.levels import fineness
from studies.scene.bellows import BellowsScene
from studies.scene.load import Scene
from studies.scene.meshes import scene_meridian

Quantities = Mapping[str, Callable[[State], float]]


def richer_problem(scene: Scene, level: str) -> tuple[Problem, Quantities]:
    """The axisymmetric problem of a scene in richer spaces, and what is read off its states, mm."""
    if isinstance(scene, BellowsScene):
        mesh = scene_meridian(scene, fineness(level))
        return scene_problem(scene, mesh, MPI.COMM_SELF, richer=True), {"tip_mm": Tip(scene, mesh).mean_mm}
    body = body_of(scene, "axisymmetric", level)
    return problem_of(scene, body, MPI.COMM_SELF, richer=True), measures(scene, body.mesh)


def errors_of(enriched: Enriched, states: Sequence[State], quantities: Quantities) -> Iterator[dict[str, float]]:
    """What is to be added to each quantity of each state; NaN where a richer equilibrium is not found.

    Parameters
    ----------
    states
        Equilibria in the order of their path: each begins with what the one before it lacked.
    """
    for state in states:
        try:
            richer = enriched.equilibrium(state)
        except StepFailed:
            yield dict.fromkeys(quantities, math.nan)
            continue
        yield {name: value(richer) - value(state) for name, value in quantities.items()}
