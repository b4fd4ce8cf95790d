"""Runs of a simple body or a user's mesh: the levels of one model."""

from __future__ import annotations

from pathlib import Path

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.solid import SolidMesh
from studies.planning.levels import MERIDIANS, Model
from studies.planning.plan import Plan
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import CylinderGeometry, MeshGeometry, TubeGeometry
from studies.scene.sections import SceneError

# Meshes of a model, coarsest first; docs/decisions.md has what errors they leave. In a body n is what the other counts
# of cells go with.
MERIDIAN_LEVELS = tuple(f"r{m}" for m in MERIDIANS)
AROUND_LEVELS = {"hexahedra": ("n8", "n16"), "tetrahedra": ("n12", "n16")}
RING_LEVELS, BLOCK_LEVELS = ("r1", "r2"), ("n2", "n3")
# A user's mesh as it is, and with its edges halved once and twice, as far as a mesh has this many nodes at most: in 3D
# one with 24,000 takes 20 s of a core, one with 100,000 some ten minutes.
USER_LEVELS, MOST_NODES = ("m1", "m2", "m4"), {2: 200_000, 3: 100_000}
COOK_LEVELS = ("n8", "n16", "n32")
CYLINDER_LEVELS = {"hexahedra": ("n8", "n12", "n16"), "tetrahedra": ("n8", "n12", "n16")}
NOT_COMPUTED = "a closed form is no model here: the exact answer stands beside every value, in rows.csv"
SLICE = "the third dimension: a slice of one cell, its faces held in their planes (plane strain)"


def plan_body(scene: BodyScene, model: Model | None = None) -> Plan:
    """Choose the runs of a simple body.

    Parameters
    ----------
    scene
        The scene.
    model
        Force this model, on all its levels; None takes the cheapest there is.

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
    levels = _levels(scene, chosen)
    stop_when_met = model is None and len(levels) == 3 and (chosen == "axisymmetric" or scene.geometry.kind == "mesh")
    skipped = _skipped(scene, chosen)
    if model is None and len(allowed) > 1:
        skipped.insert(0, "sector and full 3D: the axisymmetric model is exact for this body (force one with --model)")
    if stop_when_met:
        skipped.append(
            f"level {levels[-1]}: solved only if the first two do not hold {scene.ask.tolerance_percent:g} %"
        )
    return Plan(chosen, levels, stop_when_met, tuple(skipped))


def models_of(scene: BodyScene) -> tuple[Model, ...]:
    """Models a scene has, the cheapest first."""
    g = scene.geometry
    if isinstance(g, MeshGeometry):
        return ("axisymmetric",) if _mesh(g).dimension == 2 else ("full3d",)
    if g.kind == "ring":
        return ("sector",)
    return ("full3d",) if g.kind in ("block", "cook", "cylinder") else ("axisymmetric", "sector", "full3d")


def _mesh(g: MeshGeometry) -> SolidMesh:
    return read_user_mesh(Path(g.file), g.scale)


def cells_of(scene: BodyScene, model: str) -> str:
    """``hexahedra`` or ``tetrahedra``; on a meridian quadrilaterals or triangles go by the same names."""
    if scene.mesh.element != "auto":
        return "hexahedra" if scene.mesh.element == "hex" else "tetrahedra"
    round_bodies = ("tube", "sphere", "ventricle")
    return "tetrahedra" if model == "full3d" and scene.geometry.kind in round_bodies else "hexahedra"


def _levels(scene: BodyScene, model: Model) -> tuple[str, ...]:
    kind = scene.geometry.kind
    if kind == "cylinder":
        return CYLINDER_LEVELS[cells_of(scene, model)]
    if kind in ("tube", "sphere", "ventricle"):
        return MERIDIAN_LEVELS if model == "axisymmetric" else AROUND_LEVELS[cells_of(scene, model)]
    if isinstance(scene.geometry, MeshGeometry):
        mesh = _mesh(scene.geometry)
        fits = [len(mesh.points) * 2 ** (mesh.dimension * k) <= MOST_NODES[mesh.dimension] for k in range(1, 3)]
        return USER_LEVELS[: 1 + sum(fits)]
    return {"ring": RING_LEVELS, "block": BLOCK_LEVELS, "cook": COOK_LEVELS}[kind]


def _skipped(scene: BodyScene, model: Model) -> list[str]:
    """What a model leaves out of the body."""
    g, skipped = scene.geometry, []
    if model == "sector":
        skipped.append("the rest of the body: the sector lies between planes of symmetry")
        skipped.append("modes that break the symmetry: a sector's count of unstable modes cannot see them")
    if g.kind == "sphere":
        skipped.append("the lower half: the equator's plane is one of symmetry")
    if g.kind == "cylinder":
        skipped.append("the axisymmetric model: it has no displacement round the axis")
    if g.kind in ("cook", "ring"):
        skipped.append(SLICE)
    if isinstance(g, TubeGeometry) and g.ends == "capped":
        skipped.append("the cap: a level plate on a stiff layer that moves the bore by 1e-5 of it, which ± leaves out")
    if isinstance(g, MeshGeometry):
        skipped.append("the shape's own error: refined meshes keep the shape of the one given, and ± is of that shape")
        if len(_levels(scene, model)) == 1:
            mesh = _mesh(g)
            skipped.append(
                f"a refined mesh, without which ± is not known: of {len(mesh.points)} nodes it would make more than "
                f"the {MOST_NODES[mesh.dimension]:,} that are solved for it"
            )
    return skipped


def body_lines(scene: BodyScene, plan: Plan) -> list[str]:
    """The runs of a plan for a terminal, a line each."""
    loads = ", ".join(f"{p:g}" for p in scene.loads_kpa) + " kPa"
    if isinstance(scene.geometry, CylinderGeometry):
        loads = f"{scene.load.twist_rad_per_mm:g} rad/mm"
    lines = [f"answer: {plan.model}, {', '.join(scene.quantities)}"]
    for level in plan.levels:
        maybe = " (only if needed)" if level in plan.perhaps else ""
        lines.append(f"  {plan.model.replace('full3d', 'full 3D')} {level}: path from 0 through {loads}{maybe}")
    return lines
