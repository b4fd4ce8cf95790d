"""Half a section of a bellows with its letters: what each size of a scene is, and where it is measured."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes

from meshes.bellows import wall_segments
from meshes.shape import BellowsShape
from studies.report.pictures.half_outlines import draw_half_outline
from studies.report.style import BLACK, BLUE, GREY, HALO, SKY, VERMILION
from studies.scene.bellows import BellowsScene, shape_of

FONT: Final = 10.0
_ARROW: Final[dict[str, Any]] = {"arrowstyle": "<|-|>", "color": BLACK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
_POINTER: Final[dict[str, Any]] = {"arrowstyle": "-|>", "color": BLACK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}


def draw_lettered(axes: Axes, scene: BellowsScene, folds: int, values: bool = False) -> None:
    """Draw both ends and so many folds of a scene's actuator, mm; radii are measured to the cavity side.

    Parameters
    ----------
    axes, scene, folds
        What and where to.
    values
        Put each size beside its letter, mm.
    """
    shape = replace(shape_of(scene), convolutions=folds)
    draw_half_outline(axes, shape, scene.rings.height_mm, SKY)
    _draw_supports(axes, shape)
    _draw_letters(axes, shape, scene, folds, values)
    top = shape.seat_radius_mm + scene.rings.height_mm + 4.9
    axes.set(aspect="equal", xlim=(-3.0, shape.cavity_length_mm + shape.cap_mm + 3.5), ylim=(-0.7, top))
    axes.set_axis_off()


def _draw_supports(axes: Axes, shape: BellowsShape) -> None:
    """Axis, clamp, pressure, and the rim whose motion is the elongation."""
    end = shape.cavity_length_mm + shape.cap_mm
    axes.plot([-2.0, end + 2.0], [0.0, 0.0], color=BLACK, linewidth=0.8, linestyle=(0, (9, 3, 2, 3)))
    low, high = shape.crest_radius_mm, shape.seat_radius_mm
    for r in np.linspace(low - 0.4, high + 0.4, 7):
        axes.plot([-0.9, 0.0], [r - 0.6, r], color=BLACK, linewidth=0.9)
    axes.plot([0.0, 0.0], [low - 0.6, high + 0.6], color=BLACK, linewidth=1.6)
    axes.annotate("clamped", (-1.9, low - 1.2), ha="left", va="top", fontsize=FONT)
    rim = shape.crest_radius_mm - shape.fillet_mm
    axes.plot([end, end], [rim, high], color=VERMILION, linewidth=3.5, solid_capstyle="butt")
    axes.annotate(
        "rim: elongation", (end + 0.5, 0.5 * (rim + high)), rotation=90, va="center", fontsize=FONT, color=VERMILION
    )
    cap = shape.cavity_length_mm
    for r in (2.2, 4.6):
        axes.annotate("", (cap, r), (cap - 2.2, r), arrowprops={**_POINTER, "color": BLUE})
    axes.annotate("P", (cap - 2.4, 2.2), ha="right", va="center", fontsize=FONT, color=BLUE)


def _draw_letters(axes: Axes, shape: BellowsShape, scene: BellowsScene, folds: int, values: bool) -> None:
    """Every size at its place; radii are measured to the cavity side."""

    def named(letter: str, size_mm: float) -> str:
        return f"{letter} = {size_mm:g}" if values else letter

    crests = shape.crest_positions_mm
    root = crests[0] + shape.half_pitch_mm
    seat_r, end = shape.seat_radius_mm, shape.cavity_length_mm
    above = seat_r + scene.rings.height_mm + 1.0
    _dimension(axes, (root, 0.0), (root, shape.root_radius_mm), named("$R_i$", shape.root_radius_mm), (0.4, 0.0))
    _dimension(
        axes, (crests[1], 0.0), (crests[1], shape.crest_radius_mm), named("$R_p$", shape.crest_radius_mm), (0.4, -2.6)
    )
    for z, r in ((crests[0], shape.crest_radius_mm), (root, shape.root_radius_mm)):
        axes.plot([z, z], [1.2, r], color=GREY, linewidth=0.6, linestyle=":")
    _dimension(axes, (crests[0], 2.2), (root, 2.2), named("$e$", shape.half_pitch_mm), (0.0, 0.7))
    half = 0.5 * shape.seat_mm
    _dimension(axes, (crests[1] - half, above), (crests[1] + half, above), named("seat", shape.seat_mm), (0.0, 0.7))
    _dimension(axes, (0.0, above), (crests[0], above), named("collar", shape.collar_mm), (0.0, 0.7))
    _dimension(axes, (end, above), (end + shape.cap_mm, above), named("cap", shape.cap_mm), (0.0, 0.7))
    ring = (crests[-1] + half, seat_r + 0.5 * scene.rings.height_mm)
    axes.annotate("ring", ring, (ring[0] + 1.6, ring[1]), va="center", fontsize=FONT, arrowprops=_POINTER)
    told = f"$n$ = {scene.geometry.convolutions} convolutions, {folds} drawn"
    axes.annotate(told, (root, above + 2.4), fontsize=FONT, ha="left")
    pieces = {(s.kind, s.index, s.tangent_start_rad > 0.0): s for s in wall_segments(shape)}
    middle = np.array([0.5])
    inner, outer = (side[0, ::-1] for side in pieces["side", 0, True].band(middle))
    out = (outer - inner) / np.linalg.norm(outer - inner)
    for tip, tail in ((outer, outer + 1.6 * out), (inner, inner - 1.6 * out)):
        axes.annotate("", tip, tail, arrowprops=_POINTER)
    axes.annotate(named("$t$", shape.wall_mm), outer + 2.1 * out, ha="center", va="center", fontsize=FONT)
    # concave surfaces: the cavity side of a crest, the outside of a root
    hollow = pieces["crest", 2, True] if ("crest", 2, True) in pieces else pieces["crest", 2, False]
    crest = hollow.band(middle)[0][0, ::-1]
    bend = pieces["root", 1, True].band(np.array([1.0]))[1][0, ::-1]
    for place, text in ((crest, crest + (2.0, -3.4)), (bend, bend + (0.0, 5.0))):
        axes.annotate(
            named("fillet", shape.fillet_mm),
            place,
            text,
            ha="center",
            fontsize=FONT,
            arrowprops=_POINTER,
            path_effects=HALO,
        )


def _dimension(
    axes: Axes, one: tuple[float, float], other: tuple[float, float], letter: str, shift: tuple[float, float]
) -> None:
    """An arrow with two heads and a letter beside its middle."""
    axes.annotate("", one, other, arrowprops=_ARROW)
    middle = (0.5 * (one[0] + other[0]) + shift[0], 0.5 * (one[1] + other[1]) + shift[1])
    centred = shift[0] == 0.0
    axes.annotate(
        letter,
        middle,
        ha="center" if centred else "left",
        va="bottom" if centred else "center",
        fontsize=FONT,
        path_effects=HALO,
    )
