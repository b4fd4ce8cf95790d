"""What will be solved for a scene, what is skipped, and why."""

from __future__ import annotations

from studies.planning.bellows import bellows_lines, plan_bellows
from studies.planning.bodies import body_lines, plan_body
from studies.planning.error_model import explain
from studies.planning.levels import Model
from studies.planning.plan import Plan
from studies.planning.warnings import law_ranges, scene_warnings
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.load import Scene


def make_plan(scene: Scene, model: Model | None = None) -> Plan:
    """Choose the runs of a scene.

    Parameters
    ----------
    scene
        The scene.
    model
        Force this model; None takes the cheapest whose error can be held within the scene's tolerance.

    Raises
    ------
    SceneError
        If the model cannot be had for the scene.
    """
    return plan_body(scene, model) if isinstance(scene, BodyScene) else plan_bellows(scene, model)


def describe(scene: Scene, plan: Plan) -> str:
    """The plan as text for a terminal."""
    lines = [f"{scene.name}: {scene.title}"]
    lines += body_lines(scene, plan) if isinstance(scene, BodyScene) else bellows_lines(scene, plan)
    lines += law_ranges(scene)
    lines += [f"warning: {text}" for text in scene_warnings(scene)]
    lines += [f"skipped: {reason}" for reason in plan.skipped]
    if plan.choice is not None and isinstance(scene, BellowsScene):
        lines += explain(scene, plan.choice, plan.one_mesh)
    return "\n".join(lines)
