"""One door to the axisymmetric runs, problems and bodies of actuators and simple bodies, for counting modes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI

from meshes.solid import FACETS, SolidMesh
from solvers.assembly.surfaces import Surfaces
from solvers.problem import Problem
from studies.models.axisymmetric import run_axisymmetric
from studies.models.body import run_simple_body
from studies.models.body_problem import Body, body_of, problem_of
from studies.models.build import scene_problem
from studies.models.modes import count_run, is_counted
from studies.planning.planner import make_plan
from studies.progress import Progress
from studies.results.runs import Run
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import TubeGeometry
from studies.scene.load import Scene
from studies.scene.meshes import scene_meridian
from studies.scene.sections import SceneError


@dataclass(frozen=True)
class ModesModel:
    """A scene whose axisymmetric states are counted.

    Raises
    ------
    SceneError
        From `check`, for scenes that have no axisymmetric model.
    """

    scene: Scene

    def check(self) -> None:
        """Refuse scenes whose body is not one of revolution or has linear displacements."""
        scene = self.scene
        if isinstance(scene, BodyScene) and not isinstance(scene.geometry, TubeGeometry):
            raise SceneError(
                f"{scene.name}: geometry.kind = {scene.geometry.kind!r}: modes are counted of bellows, tube"
            )
        if scene.mesh.element == "tet-p1":
            raise SceneError(f'{scene.name}: mesh.element = "tet-p1": modes need quadratic displacements: "auto"')

    def run(self, refinement: int, folder: Path, progress: Progress) -> Run:
        """The counted axisymmetric run on a meridian, on this rank alone."""
        scene, alone = self.scene, MPI.COMM_SELF
        if not isinstance(scene, BodyScene):
            return run_axisymmetric(scene, refinement, folder, alone, progress, modes=True)
        plan = make_plan(scene, "axisymmetric")
        run = run_simple_body(scene, "axisymmetric", f"r{refinement}", folder, alone, progress, plan.skipped)
        return run if is_counted(folder, run) else count_run(folder, run, lambda: self.problem(refinement), None, True)

    def meridian(self, refinement: int) -> SolidMesh:
        """The meridian mesh."""
        if isinstance(self.scene, BodyScene):
            return body_of(self.scene, "axisymmetric", f"r{refinement}").mesh
        return scene_meridian(self.scene, refinement)

    def problem(self, refinement: int) -> Problem:
        """The axisymmetric problem."""
        scene = self.scene
        if isinstance(scene, BodyScene):
            return problem_of(scene, body_of(scene, "axisymmetric", f"r{refinement}"), MPI.COMM_SELF)
        return scene_problem(scene, scene_meridian(scene, refinement), MPI.COMM_SELF)

    def body_problem(self, body: SolidMesh) -> Problem:
        """The body's problem, held as the meridian is.

        Raises
        ------
        SceneError
            For tubes whose ends are free to drift: a body needs pins there.
        """
        scene = self.scene
        if not isinstance(scene, BodyScene):
            return scene_problem(scene, body, MPI.COMM_SELF)
        if not isinstance(scene.geometry, TubeGeometry) or scene.geometry.ends != "bonded":
            raise SceneError(f'{scene.name}: a body beside the modes needs geometry.ends = "bonded"')
        held = tuple((FACETS["top"], i) for i in range(3))
        surfaces = Surfaces(cavity=FACETS["cavity"], clamped=FACETS["bottom"], held=held)
        return problem_of(scene, Body(body, surfaces), MPI.COMM_SELF)
