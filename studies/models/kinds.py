"""One door for scenes of all kinds: bellows, simple bodies with exact answers, users' meshes.

What runs simple bodies is imported with the first of them: with all the exact solutions it takes a tenth of a second.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

from studies.models.session import SceneResult, run_plan
from studies.planning.body_plan import ExactPlan, describe_exact, make_exact_plan
from studies.planning.plan import Model, Plan, describe, make_plan
from studies.progress import Progress
from studies.scene.bodies import BodyScene
from studies.scene.files import Scene

if TYPE_CHECKING:
    from studies.models.body_session import ExactResult

AnyPlan = Plan | ExactPlan


def plan_for(scene: Scene, model: Model | None = None) -> AnyPlan:
    """The plan of a scene; see `studies.planning.plan.make_plan`.

    Raises
    ------
    SceneError
        If the model cannot be had for the scene.
    """
    return make_exact_plan(scene, model) if isinstance(scene, BodyScene) else make_plan(scene, model)


def description(scene: Scene, model: Model | None = None) -> str:
    """The plan of a scene as text for a terminal."""
    if isinstance(scene, BodyScene):
        return describe_exact(scene, make_exact_plan(scene, model))
    return describe(scene, make_plan(scene, model))


def run(
    scene: Scene, text: str, plan: AnyPlan | None, folder: Path, comm: MPI.Comm, progress: Progress
) -> SceneResult | ExactResult:
    """Run a scene's plan, or every model a simple body has if there is none; see `studies.models.session.run_plan`."""
    if isinstance(scene, BodyScene):
        from studies.models.body_session import run_all_models, run_exact_plan

        if plan is None:
            return run_all_models(scene, text, folder, comm, progress)
        assert isinstance(plan, ExactPlan)
        return run_exact_plan(scene, text, plan, folder, comm, progress)
    assert isinstance(plan, Plan)
    return run_plan(scene, text, plan, folder, comm, progress)
