"""Runs of a simple body or a user's mesh: the levels of one model."""

from __future__ import annotations

from pathlib import Path

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.solid import SolidMesh
from studies.planning.levels import FINER_MERIDIANS, MERIDIANS, MOST_UNKNOWNS, Model
from studies.planning.plan import Plan, tolerance_lines, ways
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import CylinderGeometry, MeshGeometry, TubeGeometry
from studies.scene.elements import locks
from studies.scene.sections import SceneError

# Meshes of a model, coarsest first; docs/decisions.md has what errors they leave. In a body n is what the other counts
# of cells go with.
MERIDIAN_LEVELS = tuple(f"r{m}" for m in MERIDIANS)
AROUND_LEVELS = {"hexahedra": ("n8", "n16"), "tetrahedra": ("n12", "n16")}
RING_LEVELS, BLOCK_LEVELS = ("r1", "r2"), ("n2", "n3")
# A user's mesh as it is, and with its edges halved, if that has no more than `MOST_UNKNOWNS`; and for a tolerance.
USER_LEVELS, FINER_USER = ("m1", "m2"), ("m4", "m8", "m16")
COOK_LEVELS = ("n8", "n16", "n32")
CYLINDER_LEVELS = {"hexahedra": ("n8", "n12", "n16"), "tetrahedra": ("n8", "n12", "n16")}
# The same for a tolerance that these do not hold.
FINER_AROUND, FINER_COOK, FINER_RINGS, FINER_BLOCKS = ("n24", "n32", "n48"), ("n64", "n128"), ("r4", "r8"), ("n4", "n6")
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
    stop_when_met = model is None and chosen == "axisymmetric" and len(levels) == 3
    skipped = _skipped(scene, chosen)
    if model is None and len(allowed) > 1:
        skipped.insert(0, "sector and full 3D: the axisymmetric model is exact for this body (force one with --model)")
    if stop_when_met:
        skipped.append(
            f"level {levels[-1]}: solved only if the first two do not hold {scene.ask.tolerance_percent:g} %"
        )
    return Plan(chosen, levels, stop_when_met, tuple(skipped), finer=_finer(scene, chosen))


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
        halved = len(mesh.points) * mesh.dimension * 2**mesh.dimension
        return USER_LEVELS if halved <= MOST_UNKNOWNS[model] else USER_LEVELS[:1]
    return {"ring": RING_LEVELS, "block": BLOCK_LEVELS, "cook": COOK_LEVELS}[kind]


def _finer(scene: BodyScene, model: Model) -> tuple[str, ...]:
    kind = scene.geometry.kind
    if locks(scene.mesh):
        return ()
    if model == "axisymmetric" and kind != "mesh":
        return tuple(f"r{m}" for m in FINER_MERIDIANS)
    return {"ring": FINER_RINGS, "block": FINER_BLOCKS, "cook": FINER_COOK, "mesh": FINER_USER}.get(kind, FINER_AROUND)


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
        skipped.append("the cap: a level plate on a stiff layer that moves the bore by 1e-5 of it at most, as ± says")
    if isinstance(g, MeshGeometry):
        skipped.append("the shape's own error: refined meshes keep the shape of the one given, and ± is of that shape")
        if len(_levels(scene, model)) == 1:
            skipped.append(
                f"a refined mesh, without which ± is not known: of {len(_mesh(g).points)} nodes it would have more "
                f"than {MOST_UNKNOWNS[model]:,} unknowns"
            )
    return skipped


def body_lines(scene: BodyScene, plan: Plan) -> list[str]:
    """The runs of a plan for a terminal, a line each."""
    loads = ", ".join(f"{p:g}" for p in scene.loads_kpa) + " kPa"
    if isinstance(scene.geometry, CylinderGeometry):
        loads = f"{scene.load.twist_rad_per_mm:g} rad/mm"
    lines = [f"answer: {plan.model}, {', '.join(scene.quantities)}"]
    whole = isinstance(scene.geometry, CylinderGeometry) or "limit_kpa" in scene.quantities
    for level, way in ways(plan, loads, whole):
        lines.append(f"  {plan.model.replace('full3d', 'full 3D')} {level}: {way}")
    return [*lines, *tolerance_lines(plan, scene.ask.tolerance_percent)]
