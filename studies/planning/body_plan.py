"""What will be solved for a simple body or a user's mesh, what is skipped, and why."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from meshes.user_mesh import read_user_mesh
from studies.planning.plan import Model
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import CylinderGeometry, MeshGeometry, TubeGeometry
from studies.scene.sections import SceneError

# Meshes of a model, coarsest first: r refines all, n is the number of cells round the whole circle (the cube: along an
# edge), which the other counts go with. docs/decisions.md has what errors they leave.
MERIDIAN_LEVELS = ("r1", "r2", "r4")
AROUND_LEVELS = {"hexahedra": ("n8", "n16"), "tetrahedra": ("n12", "n16")}
RING_LEVELS, BLOCK_LEVELS, USER_LEVELS = ("r1", "r2"), ("n2", "n3"), ("m1",)
COOK_LEVELS = ("n8", "n16", "n32")
CYLINDER_LEVELS = {"hexahedra": ("n8", "n12", "n16"), "tetrahedra": ("n8", "n12", "n16")}
NOT_COMPUTED = "a closed form is no model here: the exact answer stands beside every value, in rows.csv"


@dataclass(frozen=True)
class ExactPlan:
    """The runs of a scene.

    Attributes
    ----------
    model
        The model.
    levels
        Its meshes, coarsest first; the last one's result is the answer.
    stop_when_met
        True to leave out the last level if the first two already hold the scene's tolerance.
    skipped
        What is not computed and why, a sentence each.
    """

    model: Model
    levels: tuple[str, ...]
    stop_when_met: bool
    skipped: tuple[str, ...]


def cells_of(scene: BodyScene, model: str) -> str:
    """``hexahedra`` or ``tetrahedra``; on a meridian quadrilaterals or triangles go by the same names."""
    if scene.mesh.element != "auto":
        return "hexahedra" if scene.mesh.element == "hex" else "tetrahedra"
    round_bodies = ("tube", "sphere", "ventricle")
    return "tetrahedra" if model == "full3d" and scene.geometry.kind in round_bodies else "hexahedra"


def make_exact_plan(scene: BodyScene, model: Model | None = None) -> ExactPlan:
    """Choose the runs of a scene.

    Parameters
    ----------
    scene
        The scene.
    model
        Force this model; None takes the cheapest there is.

    Returns
    -------
    ExactPlan

    Raises
    ------
    SceneError
        If the model cannot be had for the scene.
    """
    allowed = models_of(scene)
    chosen = model or allowed[0]
    if chosen not in allowed:
        why = NOT_COMPUTED if chosen == "closed_form" else f"a {scene.geometry.kind} has {', '.join(allowed)}"
        raise SceneError(f"{scene.name}: --model {chosen}: {why}")
    if chosen == "sector" and scene.mesh.element.startswith("tet"):
        raise SceneError(f'{scene.name}: a sector is meshed in hexahedra: it needs mesh.element = "hex" or "auto"')
    kind, skipped = scene.geometry.kind, []
    if model is None and len(allowed) > 1:
        skipped.append("sector and full 3D: the axisymmetric model is exact for this body (force one with --model)")
    if chosen == "sector":
        skipped.append("the rest of the body: the sector lies between planes of symmetry")
        skipped.append("modes that break the symmetry: a sector's count of unstable modes cannot see them")
    if kind == "sphere":
        skipped.append("the lower half: the equator's plane is one of symmetry")
    if kind == "cook":
        skipped.append("the third dimension: a slice of one cell, its faces held in their planes (plane strain)")
    if isinstance(scene.geometry, CylinderGeometry):
        skipped.append("the axisymmetric model: it has no displacement round the axis")
    if kind == "ring":
        skipped.append("the third dimension: a slice of one cell, its faces held in their planes (plane strain)")
    if isinstance(scene.geometry, TubeGeometry) and scene.geometry.ends == "capped":
        skipped.append("the cap: a level plate on a stiff layer that moves the bore by 1e-5 of it, which ± leaves out")
    levels: tuple[str, ...]
    if kind == "cylinder":
        levels = CYLINDER_LEVELS[cells_of(scene, chosen)]
    elif kind in ("tube", "sphere", "ventricle"):
        levels = MERIDIAN_LEVELS if chosen == "axisymmetric" else AROUND_LEVELS[cells_of(scene, chosen)]
    else:
        levels = {"ring": RING_LEVELS, "block": BLOCK_LEVELS, "cook": COOK_LEVELS, "mesh": USER_LEVELS}[kind]
    if kind == "mesh":
        skipped.append("a second mesh: the discretisation's uncertainty is not known from one")
    stop = model is None and chosen == "axisymmetric" and len(levels) == 3
    if stop:
        skipped.append(
            f"level {levels[-1]}: solved only if the first two do not hold {scene.ask.tolerance_percent:g} %"
        )
    return ExactPlan(chosen, levels, stop, tuple(skipped))


def describe_exact(scene: BodyScene, plan: ExactPlan) -> str:
    """The plan as text for a terminal."""
    loads = ", ".join(f"{p:g}" for p in scene.loads_kpa) + " kPa"
    if isinstance(scene.geometry, CylinderGeometry):
        loads = f"{scene.load.twist_rad_per_mm:g} rad/mm"
    lines = [f"{scene.name}: {scene.title}", f"answer: {plan.model}, {', '.join(scene.quantities)}"]
    for level in plan.levels:
        maybe = " (only if needed)" if plan.stop_when_met and level == plan.levels[-1] else ""
        lines.append(f"  {plan.model.replace('full3d', 'full 3D')} {level}: path from 0 through {loads}{maybe}")
    return "\n".join([*lines, *(f"skipped: {reason}" for reason in plan.skipped)])


def models_of(scene: BodyScene) -> tuple[Model, ...]:
    """Models a scene has, the cheapest first."""
    g = scene.geometry
    if isinstance(g, MeshGeometry):
        return ("axisymmetric",) if read_user_mesh(Path(g.file), g.scale).dimension == 2 else ("full3d",)
    if g.kind == "ring":
        return ("sector",)
    return ("full3d",) if g.kind in ("block", "cook", "cylinder") else ("axisymmetric", "sector", "full3d")
