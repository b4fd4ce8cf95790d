"""What will be solved for a scene, what is skipped, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from studies.planning.error_model import (
    MERIDIAN_SHARE,
    Choice,
    around_for,
    choose,
    explain,
    knows,
    meridians_for,
)
from studies.scene.bellows import RING_ERROR_PERCENT, BellowsScene, in_hexahedra
from studies.scene.sections import SceneError

Model = Literal["closed_form", "axisymmetric", "sector", "full3d"]
MODELS: tuple[Model, ...] = ("closed_form", "axisymmetric", "sector", "full3d")

# Meridian refinements for the error estimate; a body of revolution is made from the coarsest that is good enough.
MERIDIAN_LEVELS = (1, 2, 4)
# Bodies on r4 would not fit the machines this is meant for (24 GB).
BODY_LEVELS = (1, 2)
# Cells round the circumference from which a sector tells that part of the error, where they share out to a quarter.
SECTOR_LEVELS = (8, 16, 24)


@dataclass(frozen=True)
class Plan:
    """The runs of a scene.

    Attributes
    ----------
    model
        The model whose result is the answer.
    meridian_levels
        Refinements of the axisymmetric runs, coarsest first.
    around_levels
        Numbers of cells round the circumference of the 3D runs; empty for none.
    sector_levels
        The same of a sector beside full 3D, for the circumference's part of the error; empty for none.
    body_levels
        Meridians that a body may be made from: the first whose error is within its share of the tolerance, or the last.
    stop_when_met
        True to leave out meridian levels once those before hold the scene's tolerance, or a body's share of it.
    skipped
        What is not computed and why, a sentence each.
    choice
        The mesh that the error model proposes and what it expects of it; None where it knows nothing of the scene.
    """

    model: Model
    meridian_levels: tuple[int, ...]
    around_levels: tuple[int, ...]
    stop_when_met: bool
    skipped: tuple[str, ...]
    sector_levels: tuple[int, ...] = ()
    body_levels: tuple[int, ...] = BODY_LEVELS
    choice: Choice | None = None


def make_plan(
    scene: BellowsScene,
    model: Model | None = None,
    around: tuple[int, ...] = (),
    sectors: tuple[int, ...] = (),
    every_level: bool = False,
) -> Plan:
    """Choose the runs of a scene.

    Parameters
    ----------
    scene
        The scene.
    model
        Force this model; None takes the cheapest whose error can be held within the scene's tolerance.
    around
        Numbers of cells round the circumference for 3D; default what the scene's tolerance needs.
    sectors
        The same for a sector beside full 3D.
    every_level
        Solve all meridian levels, for the convergence study of a report.

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        If the model cannot be had for the scene.
    """
    if model == "sector" and not in_hexahedra(scene):
        raise SceneError(
            f'{scene.name}: a sector is meshed in hexahedra: it needs mesh.element = "hex" and rigid rings'
        )
    skipped = []
    off_axis = scene.geometry.eccentricity > 0.0
    if off_axis and model not in (None, "full3d"):
        raise SceneError(
            f"{scene.name}: geometry.eccentricity = {scene.geometry.eccentricity:g} is not rotationally symmetric: it "
            f"needs --model full3d, not {model}; set it to 0 for the centred core"
        )
    chosen: Model = model or ("full3d" if off_axis else "axisymmetric")
    if model is None and not off_axis:
        skipped.append(
            "closed form: it has no vacuum"
            if scene.load.sense < 0.0
            else "closed form as the answer: its error is not bounded, so it cannot promise "
            f"{scene.ask.tolerance_percent:g} %; it is computed beside the finite elements"
        )
        skipped.append(
            "full 3D: geometry, material and load are rotationally symmetric, so the axisymmetric model "
            "is exact for them (force it with --model full3d)"
        )
    if off_axis:
        skipped.append(
            "the axisymmetric model as the answer: the core sat off the axis; it solves the centred one, the limit to "
            "compare with and the first guesses"
        )
    if chosen == "closed_form" and scene.load.tip_force_n:
        raise SceneError(
            f"{scene.name}: the closed form has no force on its tip: set load.tip_force_n = 0 "
            f"(it is {scene.load.tip_force_n:g}) or ask for --model axisymmetric"
        )
    if chosen == "closed_form" and scene.load.sense < 0.0:
        raise SceneError(f"{scene.name}: the closed form has no vacuum: ask for --model axisymmetric")
    if chosen == "axisymmetric" and scene.blocked and not scene.ask.modes:
        skipped.append("modes that bend the actuator sideways: a blocked one may squirm (ask.modes = true counts them)")
    if chosen == "closed_form":
        return Plan(chosen, (), (), False, ("finite elements: the closed form was forced",))
    if scene.rings.model == "rigid":
        error = RING_ERROR_PERCENT[scene.rings.material]
        skipped.append(
            f"interior of the rings: as rigid bodies they change the tip by {error:g} % at most "
            '(rings.model = "meshed" solves them)'
        )
    if scene.geometry.tip == "rigid":
        skipped.append('the cap: a rigid plate bonded to the distal collar (geometry.tip = "cap" solves it)')
    watched = chosen == "axisymmetric" and scene.contact.model == "auto" and scene.rings.model in ("rigid", "none")
    skipped.append("contact: modelled from the first touch on" if watched else "contact: not modelled here")
    choice = choose(scene, chosen) if knows(scene) else None
    stop_when_met = not every_level and (model is None or chosen != "axisymmetric")
    levels: tuple[int, ...] = MERIDIAN_LEVELS
    if choice is not None and stop_when_met:
        levels = tuple(m for m in levels if m >= meridians_for(choice)[0])
    if chosen == "axisymmetric":
        return Plan(chosen, levels, (), stop_when_met, tuple(skipped), choice=choice)
    if chosen == "sector":
        skipped.append("three quarters of the body: what is left lies between two planes of symmetry")
        skipped.append("modes that break the symmetry: a sector's count of unstable modes cannot see them")
    if not around:
        skipped.append(
            f"more cells round the circumference than a tolerance of {scene.ask.tolerance_percent:g} % needs: a tenth "
            "of it is left to them"
        )
    skipped.append("load steps of the 3D run: each requested pressure starts from the axisymmetric state, revolved")
    skipped.append(
        f"finer meridians of the body than a tolerance of {scene.ask.tolerance_percent:g} % needs: "
        f"{MERIDIAN_SHARE:.0%} of it are left to the meridian, as the axisymmetric levels show it"
    )
    rounds = around or (around_for(scene, chosen),)
    return Plan(chosen, levels, rounds, stop_when_met, tuple(skipped), sectors, choice=choice)


def describe(scene: BellowsScene, plan: Plan) -> str:
    """The plan as text for a terminal."""
    lines = [f"{scene.name}: {scene.title}", f"answer: {plan.model}"]
    pressures = ", ".join(f"{p:g}" for p in scene.load.pressure_kpa)
    if scene.load.sense > 0.0:
        lines.append(f"  closed form at {pressures} kPa")
    for level in plan.meridian_levels:
        maybe = " (only if needed)" if plan.stop_when_met and level in plan.meridian_levels[2:] else ""
        lines.append(f"  axisymmetric, meridian level r{level}: path from 0 through {pressures} kPa{maybe}")
    body = "a quarter in 3D" if plan.model == "sector" else "full 3D"
    cells = "hexahedra" if in_hexahedra(scene) else "tetrahedra"
    levels = " or ".join(f"r{level}" for level in plan.body_levels)
    for around in plan.sector_levels:
        lines.append(
            f"  a quarter in 3D, {cells}, meridian level r{plan.body_levels[0]}, {around} cells round: {pressures} kPa"
        )
    for around in plan.around_levels:
        lines.append(f"  {body}, {cells}, meridian level {levels}, {around} cells round: {pressures} kPa")
    lines += [f"skipped: {reason}" for reason in plan.skipped]
    lines += explain(scene, plan.choice) if plan.choice is not None else []
    return "\n".join(lines)
