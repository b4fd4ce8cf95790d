"""What the closed form and the paper say of a scene, beside which the finite elements are compared."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.bellows.chains import ClosedFormPath, closed_form, closed_form_balanced, closed_form_printed
from analytical.bellows.dimensions import BellowsDimensions, BellowsError, with_seat
from analytical.bellows.loads import held_tip
from analytical.laws.isotropic import Law
from meshes.bellows import wall_segments
from meshes.shape import BellowsShape
from studies.results.rows import FOLDED_BACK, REACHED, Row, row
from studies.scene.bellows import BellowsScene, dimensions_of, shape_of
from studies.scene.materials import law_of

Chain = Callable[[BellowsDimensions, Law, ArrayLike], ClosedFormPath]


def closed_form_values(scene: BellowsScene, pressure_kpa: float) -> list[tuple[str, float, str]]:
    """(model, main quantity, status) of the closed form: its chains, and the corrected one with the outline's lengths.

    Those are the free half pitch alone (``closed_form_seat``), and the free wall's too (``closed_form_outline``).
    """
    if scene.load.sense < 0.0:
        return []  # it has no vacuum
    out = []
    for model, (chain, dimensions) in _chains(scene).items():
        try:
            value, status = _closed_form_value(scene, chain, dimensions, pressure_kpa)
            out.append((model, value, status))
        except BellowsError as error:
            out.append((model, math.nan, f"not available: {error}"))
    if not (scene.blocked or scene.load.tip_force_n) and all(math.isfinite(value) for _, value, _ in out[:1]):
        fed = fed_mm(scene, pressure_kpa)[0]
        spans = math.isfinite(fed)
        out.append(("closed_form_outline", fed, REACHED if spans else "not available: the wall cannot span the fold"))
    return out


@cache
def free_wall_mm(shape: BellowsShape) -> float:
    """Length of the wall's middle line between a seat and the middle of the next root, mm."""
    pieces = [s.length_mm for s in wall_segments(shape) if s.kind in ("crest", "side", "root")]
    return sum(pieces) / (2.0 * shape.convolutions)


def fed_mm(scene: BellowsScene, pressure_kpa: float) -> tuple[float, float]:
    """The corrected closed form fed with the outline's free wall and half pitch, mm.

    Eq. (23) of DOI 10.3390/biomimetics9030160 with the chain's own stretches, the free wall's length for l and the half
    pitch less half the seat for e. The free wall is longer than the straight line it is put on, so the formula is
    longer than the bellows before there is any pressure: by the slack that its bends could give if they straightened.

    Returns
    -------
    tuple of float
        As it stands, with all bends straight; and less the slack at rest. NaN if the wall cannot span the fold.
    """
    d, shape = dimensions_of(scene), shape_of(scene)
    chain = closed_form(d, law_of(scene.material), pressure_kpa)
    length, half_pitch = free_wall_mm(shape), shape.half_pitch_mm - 0.5 * shape.seat_mm

    def elongation(root: float, wall: float) -> float:
        drop = d.crest_radius_mm + d.wall_mm - root * (d.root_radius_mm + d.wall_mm)
        square = (wall * length) ** 2 - drop**2
        return 2.0 * d.convolutions * (math.sqrt(square) - half_pitch) if square >= 0.0 else math.nan

    fed = elongation(float(chain.root_stretch[0]), float(chain.wall_stretch[0]))
    return fed, fed - elongation(1.0, 1.0)


def _chains(scene: BellowsScene) -> dict[str, tuple[Chain, BellowsDimensions]]:
    """By model the chain and the dimensions it takes."""
    nominal = dimensions_of(scene)
    found: dict[str, tuple[Chain, BellowsDimensions]] = {"closed_form": (closed_form, nominal)}
    if scene.rings.model != "none":
        found["closed_form_seat"] = (closed_form, with_seat(nominal, scene.rings.seat_mm))
    if not scene.blocked:
        found["closed_form_printed"] = (closed_form_printed, nominal)
        found["closed_form_balanced"] = (closed_form_balanced, nominal)
    return found


def closed_form_curve(scene: BellowsScene, model: str, pressures_kpa: FloatArray) -> FloatArray:
    """The main quantity of a scene by one of its chains at many pressures (kPa), for curves.

    Returns
    -------
    ndarray
        mm or N, of the shape of the pressures; NaN where the chain has folded back or has no answer.
    """
    chain, dimensions = _chains(scene)[model]
    law = law_of(scene.material)
    try:
        if scene.blocked:
            return held_tip(dimensions, law, pressures_kpa).tip_force_n
        answer = chain(dimensions, law, pressures_kpa)
    except BellowsError:
        return np.full(pressures_kpa.shape, np.nan)
    return np.where(answer.state == "past the model", np.nan, answer.elongation_mm)


def _closed_form_value(
    scene: BellowsScene, chain: Chain, dimensions: BellowsDimensions, pressure_kpa: float
) -> tuple[float, str]:
    """The main quantity of a scene by a chain, mm or N, and in which state the chain is if it is past the model."""
    law = law_of(scene.material)
    if scene.blocked:
        return float(held_tip(dimensions, law, pressure_kpa).tip_force_n[0]), REACHED
    if scene.load.tip_force_n:
        raise BellowsError("it has no force on its tip")
    return _elongation(chain, dimensions, law, pressure_kpa)


@cache
def _elongation(chain: Chain, dimensions: BellowsDimensions, law: Law, pressure_kpa: float) -> tuple[float, str]:
    """A chain's elongation, mm, and its state; kept, for a study's variants and audits ask for the same again."""
    answer = chain(dimensions, law, pressure_kpa)
    return float(answer.elongation_mm[0]), FOLDED_BACK if answer.state[0] == "past the model" else REACHED


def thrust_rows(scene: BellowsScene, pressure_kpa: float) -> list[Row]:
    """Thrust of the pressure alone by the closed form: the tip force of a wall that buckles rather than push."""
    try:
        thrust = held_tip(dimensions_of(scene), law_of(scene.material), pressure_kpa).extension_force_n
    except BellowsError:
        return []
    return [row(scene.name, "extension_force_n", "N", pressure_kpa, "closed_form", float(thrust[0]))]


def printed_elongation(scene: BellowsScene) -> paper.PrintedElongation | None:
    """What the paper prints of a scene's actuator; None if it is not one of the paper's."""
    if scene.blocked or scene.load.tip_force_n:
        return None  # the paper's tips are free
    g = scene.geometry
    return paper.printed(g.wall_mm, g.root_radius_mm, g.crest_radius_mm, g.half_pitch_mm, g.convolutions)


def validity_notes(scene: BellowsScene) -> list[str]:
    """What a reader must know of the closed form's and the paper's numbers for a scene."""
    dimensions, law = dimensions_of(scene), law_of(scene.material)
    notes = []
    if scene.blocked:
        notes.append(
            "The closed form's force at the tip, held at zero elongation, assumes a wall that pushes; one that buckles "
            "instead leaves the thrust of the pressure, extension_force_n."
        )
    if scene.load.tip_force_n:
        return ["The closed form has no force on its tip."]
    if scene.load.sense < 0.0:
        return ["The closed form has no vacuum."]
    try:
        answer = closed_form(dimensions, law, np.array(scene.load.pressure_kpa))
    except BellowsError as error:
        return [*notes, f"The closed form has no answer up to {scene.load.pressure_kpa[-1]:g} kPa: {error}."]
    unfolding_kpa = float(answer.unfolding_pressure_kpa[0])
    if unfolding_kpa <= scene.load.pressure_kpa[-1]:
        notes.append(
            f"The closed form is fully unfolded from {unfolding_kpa:.1f} kPa; beyond, its root "
            "stretch is held there (the paper stops at full expansion)."
        )
    else:
        notes.append(f"The closed form unfolds fully only at {unfolding_kpa:.1f} kPa, above the asked range.")
    printed = printed_elongation(scene)
    if printed is not None:
        notes.append(f"Printed values ({printed.source}): {printed.reading}.")
        notes.append(
            "The paper prints neither R_p, e and n nor which silicone each actuator has: these are inferred from "
            "its closed-form column alone, so agreement of the closed form with that column is no validation."
        )
    return notes
