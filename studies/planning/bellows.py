"""Runs of a bellows: axisymmetric levels, then a 3D body made from one of their meridians where that is wanted."""

from __future__ import annotations

from studies.planning.error_model import MERIDIAN_SHARE, around_for, choose, knows, meridians_for
from studies.planning.levels import FINER_MERIDIANS, MERIDIANS, Model
from studies.planning.plan import Plan, tolerance_lines, ways
from studies.scene.bellows import RING_ERROR_PERCENT, BellowsScene, in_hexahedra
from studies.scene.elements import USUAL_ELEMENTS, locks
from studies.scene.meshes import solved_part, symmetry_note
from studies.scene.sections import SceneError

# Depth of the folds over the wall: 1.75 is the least among the scenes compared; at 1.2 a drawn one was 1 % off.
LEAST_DEPTH = 1.7


def plan_bellows(
    scene: BellowsScene,
    model: Model | None = None,
    around: tuple[int, ...] = (),
    every_level: bool = False,
) -> Plan:
    """Choose the runs of a bellows.

    Parameters
    ----------
    scene
        The scene.
    model
        Force this model; None takes the cheapest whose error can be held within the scene's tolerance.
    around
        Numbers of cells round the circumference for 3D; default what the scene's tolerance needs.
    every_level
        Solve all meridian levels, for the convergence study of a report. Meshes that are said, by this or by numbers of
        cells round, are solved whatever they leave of error: no tolerance is asked of them.

    Raises
    ------
    SceneError
        If the model cannot be had for the scene.
    """
    if model is not None:
        _refuse(scene, model)
    chosen: Model = model or ("full3d" if scene.geometry.eccentricity else "axisymmetric")
    if chosen == "closed_form":
        return Plan(chosen, (), False, ("finite elements: the closed form was forced",), fixed=True)
    skipped = [*_other_models(scene, model), *_not_modelled(scene, chosen)]
    choice = choose(scene, chosen) if knows(scene) else None
    stop_when_met = not every_level and (model is None or chosen != "axisymmetric")
    coarsest = meridians_for(choice)[0] if choice is not None and stop_when_met else MERIDIANS[0]
    levels = tuple(f"r{m}" for m in MERIDIANS if m >= coarsest)
    fixed = every_level or bool(around)
    finer = () if fixed or locks(scene.mesh) else tuple(f"r{m}" for m in FINER_MERIDIANS)
    one_mesh = stop_when_met and coarsest == MERIDIANS[0] and tells_its_error(scene)
    if chosen == "axisymmetric":
        return Plan(
            chosen,
            levels,
            stop_when_met,
            tuple(skipped),
            finer=finer,
            fixed=fixed,
            choice=choice,
            one_mesh=one_mesh,
        )
    rounds = around or (around_for(scene, chosen),)
    skipped += _left_out_in_3d(scene, chosen, rounds, bool(around))
    return Plan(
        chosen,
        levels,
        stop_when_met,
        tuple(skipped),
        rounds,
        finer=finer,
        fixed=fixed,
        choice=choice,
        one_mesh=one_mesh,
    )


def tells_its_error(scene: BellowsScene) -> bool:
    """True for scenes whose estimates on r1 ``make study-dual`` has held against finer meshes.

    Not among them: meshed rings, layers as bonds, plates and forces at the tip, vacuum; folds hardly deeper than the
    wall, whose error is that of the shape of r1's cells in the bends, which richer spaces keep.
    """
    g, rings, load = scene.geometry, scene.rings, scene.load
    as_moulded = g.tip == "cap" and rings.model == "rigid" and rings.bond == "rigid"
    usual_elements = scene.mesh.element in USUAL_ELEMENTS
    free = load.tip == "free" and not load.tip_force_n
    deep = g.crest_radius_mm - g.root_radius_mm >= LEAST_DEPTH * g.wall_mm
    return as_moulded and usual_elements and free and load.sense > 0.0 and deep


def _refuse(scene: BellowsScene, model: Model) -> None:
    """Raise a SceneError if a model cannot be had for the scene."""
    name = scene.name
    if model == "sector" and not in_hexahedra(scene):
        raise SceneError(f'{name}: a sector is meshed in hexahedra: it needs mesh.element = "hex"')
    if scene.geometry.eccentricity and model != "full3d":
        raise SceneError(
            f"{name}: geometry.eccentricity = {scene.geometry.eccentricity:g} is not rotationally symmetric: it "
            f"needs --model full3d, not {model}; set it to 0 for the centred core"
        )
    if model == "closed_form" and scene.load.tip_force_n:
        raise SceneError(
            f"{name}: the closed form has no force on its tip: set load.tip_force_n = 0 "
            f"(it is {scene.load.tip_force_n:g}) or ask for --model axisymmetric"
        )
    if model == "closed_form" and scene.load.sense < 0.0:
        raise SceneError(f"{name}: the closed form has no vacuum: ask for --model axisymmetric")


def _other_models(scene: BellowsScene, forced: Model | None) -> list[str]:
    """Why other models are not the answer."""
    if scene.geometry.eccentricity:
        return [
            "the axisymmetric model as the answer: the core sat off the axis; it solves the centred one, the limit to "
            "compare with and the first guesses"
        ]
    if forced is not None:
        return []
    return [
        "closed form: it has no vacuum"
        if scene.load.sense < 0.0
        else "closed form as the answer: its error is not bounded, so it cannot promise "
        f"{scene.ask.tolerance_percent:g} %; it is computed beside the finite elements",
        "full 3D: geometry, material and load are rotationally symmetric, so the axisymmetric model "
        "is exact for them (force it with --model full3d)",
    ]


def _not_modelled(scene: BellowsScene, model: Model) -> list[str]:
    """What a model leaves out of the actuator."""
    skipped = []
    if model == "axisymmetric" and scene.blocked and not scene.ask.modes:
        skipped.append("modes that bend the actuator sideways: a blocked one may squirm (ask.modes = true counts them)")
    if scene.rings.model == "rigid":
        error = RING_ERROR_PERCENT[scene.rings.material]
        skipped.append(
            f"interior of the rings: as rigid bodies they change the tip by {error:g} % at most "
            '(rings.model = "meshed" solves them)'
        )
    if scene.geometry.tip == "rigid":
        skipped.append('the cap: a rigid plate bonded to the distal collar (geometry.tip = "cap" solves it)')
    watched = model == "axisymmetric" and scene.contact.model == "auto" and scene.rings.model in ("rigid", "none")
    skipped.append("contact: modelled from the first touch on" if watched else "contact: not modelled here")
    return skipped


def _left_out_in_3d(scene: BellowsScene, model: Model, rounds: tuple[int, ...], rounds_given: bool) -> list[str]:
    """What a body in 3D leaves out."""
    tolerance = f"a tolerance of {scene.ask.tolerance_percent:g} % needs"
    skipped = []
    if model == "sector":
        skipped.append("three quarters of the body: what is left lies between two planes of symmetry")
        skipped.append("modes that break the symmetry: a sector's count of unstable modes cannot see them")
    else:
        skipped += dict.fromkeys(symmetry_note(scene, around) for around in rounds)
    if not rounds_given:
        skipped.append(f"more cells round the circumference than {tolerance}: a tenth of it is left to them")
    skipped.append("load steps of the 3D run: each requested pressure starts from the axisymmetric state, revolved")
    skipped.append(
        f"finer meridians of the body than {tolerance}: {MERIDIAN_SHARE:.0%} of it are left to the meridian, as the "
        "axisymmetric levels show it"
    )
    return skipped


def bellows_lines(scene: BellowsScene, plan: Plan) -> list[str]:
    """The runs of a plan for a terminal, a line each."""
    lines = [f"answer: {plan.model}"]
    pressures = ", ".join(f"{p:g}" for p in scene.load.pressure_kpa)
    if scene.load.sense > 0.0:
        lines.append(f"  closed form at {pressures} kPa")
    for level, way in ways(plan, f"{pressures} kPa"):
        lines.append(f"  axisymmetric, meridian level {level}: {way}")
    body = "a quarter in 3D" if plan.model == "sector" else "full 3D"
    cells = "hexahedra" if in_hexahedra(scene) else "tetrahedra"
    meridians = " or ".join(f"r{level}" for level in plan.body_levels)
    for around in plan.around_levels:
        part = solved_part(scene, around)[0] if plan.model == "full3d" else ""
        solved = body + {"sector": " on a quarter", "half": " on a half"}.get(part, "")
        lines.append(f"  {solved}, {cells}, meridian level {meridians}, {around} cells round: {pressures} kPa")
    return [*lines, *tolerance_lines(plan, scene.ask.tolerance_percent)]
