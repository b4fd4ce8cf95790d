"""The outline with its letters: ends and two folds, as moulded and near the zigzag of the paper's figure 2."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes

from meshes.bellows import wall_segments
from meshes.shape import BellowsShape
from studies.paper.setup.sizes import ZIGZAG, scene_of
from studies.report.pictures.half_outlines import draw_half_outline
from studies.report.style import BLACK, BLUE, GREY, HALO, SKY, VERMILION, figure_file
from studies.scene.bellows import BellowsScene, shape_of

# Drawn of all folds, so that the letters have room.
FOLDS: Final = 2
_FONT: Final = 10.0
_ARROW: Final[dict[str, Any]] = {"arrowstyle": "<|-|>", "color": BLACK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
_POINTER: Final[dict[str, Any]] = {"arrowstyle": "-|>", "color": BLACK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}


def draw_outlines(path: Path, name: str) -> str:
    """Draw an actuator's half section with letters, as moulded beside the zigzag outline, to one scale, mm."""
    found = {"as moulded": scene_of(name), "zigzag outline": scene_of(name, ZIGZAG)}
    with figure_file(path, 11.0, 3.7) as figure:
        for axes, (title, scene) in zip(figure.subplots(1, 2, sharey=True), found.items(), strict=True):
            shape = replace(shape_of(scene), convolutions=FOLDS)
            draw_half_outline(axes, shape, scene.rings.height_mm, SKY)
            _draw_supports(axes, shape)
            _draw_letters(axes, shape, scene)
            fillet, seat = scene.geometry.fillet_mm, scene.rings.seat_mm
            axes.set_title(f"{title}: fillet {fillet:g} mm, seat {seat:g} mm", fontsize=_FONT)
            axes.set(aspect="equal", xlim=(-3.0, shape.cavity_length_mm + shape.cap_mm + 3.5), ylim=(-0.7, 19.4))
            axes.set_axis_off()
    return ""


def _draw_supports(axes: Axes, shape: BellowsShape) -> None:
    """Axis, clamp, pressure, and the rim whose motion is the elongation."""
    end = shape.cavity_length_mm + shape.cap_mm
    axes.plot([-2.0, end + 2.0], [0.0, 0.0], color=BLACK, linewidth=0.8, linestyle=(0, (9, 3, 2, 3)))
    low, high = shape.crest_radius_mm, shape.seat_radius_mm
    for r in np.linspace(low - 0.4, high + 0.4, 7):
        axes.plot([-0.9, 0.0], [r - 0.6, r], color=BLACK, linewidth=0.9)
    axes.plot([0.0, 0.0], [low - 0.6, high + 0.6], color=BLACK, linewidth=1.6)
    axes.annotate("clamped", (-1.9, low - 1.2), ha="left", va="top", fontsize=_FONT)
    rim = shape.crest_radius_mm - shape.fillet_mm
    axes.plot([end, end], [rim, high], color=VERMILION, linewidth=3.5, solid_capstyle="butt")
    axes.annotate(
        "rim: elongation", (end + 0.5, 0.5 * (rim + high)), rotation=90, va="center", fontsize=_FONT, color=VERMILION
    )
    cap = shape.cavity_length_mm
    for r in (2.2, 4.6):
        axes.annotate("", (cap, r), (cap - 2.2, r), arrowprops={**_POINTER, "color": BLUE})
    axes.annotate("P", (cap - 2.4, 2.2), ha="right", va="center", fontsize=_FONT, color=BLUE)


def _draw_letters(axes: Axes, shape: BellowsShape, scene: BellowsScene) -> None:
    """Every size at its place; radii are measured to the cavity side."""
    crests = shape.crest_positions_mm
    root = crests[0] + shape.half_pitch_mm
    seat_r, end = shape.seat_radius_mm, shape.cavity_length_mm
    above = seat_r + scene.rings.height_mm + 1.0
    _dimension(axes, (root, 0.0), (root, shape.root_radius_mm), "$R_i$", (0.4, 0.0))
    _dimension(axes, (crests[1], 0.0), (crests[1], shape.crest_radius_mm), "$R_p$", (0.4, -2.6))
    for z, r in ((crests[0], shape.crest_radius_mm), (root, shape.root_radius_mm)):
        axes.plot([z, z], [1.2, r], color=GREY, linewidth=0.6, linestyle=":")
    _dimension(axes, (crests[0], 2.2), (root, 2.2), "$e$", (0.0, 0.7))
    half = 0.5 * shape.seat_mm
    _dimension(axes, (crests[1] - half, above), (crests[1] + half, above), "seat", (0.0, 0.7))
    _dimension(axes, (0.0, above), (crests[0], above), "collar", (0.0, 0.7))
    _dimension(axes, (end, above), (end + shape.cap_mm, above), "cap", (0.0, 0.7))
    ring = (crests[-1] + half, seat_r + 0.5 * scene.rings.height_mm)
    axes.annotate("ring", ring, (ring[0] + 1.6, ring[1]), va="center", fontsize=_FONT, arrowprops=_POINTER)
    folds = f"$n$ = {scene.geometry.convolutions} convolutions, {FOLDS} drawn"
    axes.annotate(folds, (root, above + 2.4), fontsize=_FONT, ha="left")
    pieces = {(s.kind, s.index, s.tangent_start_rad > 0.0): s for s in wall_segments(shape)}
    middle = np.array([0.5])
    inner, outer = (side[0, ::-1] for side in pieces["side", 0, True].band(middle))
    out = (outer - inner) / np.linalg.norm(outer - inner)
    for tip, tail in ((outer, outer + 1.6 * out), (inner, inner - 1.6 * out)):
        axes.annotate("", tip, tail, arrowprops=_POINTER)
    axes.annotate("$t$", outer + 2.1 * out, ha="center", va="center", fontsize=_FONT)
    # concave surfaces: the cavity side of a crest, the outside of a root
    hollow = pieces["crest", 2, True] if ("crest", 2, True) in pieces else pieces["crest", 2, False]
    crest = hollow.band(middle)[0][0, ::-1]
    bend = pieces["root", 1, True].band(np.array([1.0]))[1][0, ::-1]
    for place, text in ((crest, crest + (2.0, -3.4)), (bend, bend + (0.0, 5.0))):
        axes.annotate("fillet", place, text, ha="center", fontsize=_FONT, arrowprops=_POINTER, path_effects=HALO)


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
        fontsize=_FONT,
        path_effects=HALO,
    )
