"""Pictures of the study of the unprinted dimensions: sets that fit, what they predict, outlines of the picked ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.chains_by_name import SILICONES, printed_mm
from analytical.bellows.fit.members import WITHIN, tip_mm
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, Silicone
from studies.dimensions.fit import ACTUATORS, SET_NAMES, Fit
from studies.dimensions.predictions import Prediction
from studies.dimensions.scenes import scene_of
from studies.dimensions.tables import of_silicone, silicones_text
from studies.report.pictures.half_outlines import draw_half_outline
from studies.report.style import (
    BELOW,
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    entry,
    figure_file,
    grid,
    white_edged,
)
from studies.scene.bellows import shape_of

# Of the picked sets: told apart by shape as well as by colour, lines by their dashes.
_PICKS: Final[tuple[dict[str, Any], ...]] = (
    {"color": VERMILION, "marker": "*", "markersize": 15.0},
    {"color": BLUE, "marker": "D", "markersize": 7.5},
    {"color": GREEN, "marker": "s", "markersize": 8.0},
)
_DASHES: Final = ("-", "--", ":")
# Dots and bands of all that fit, and of those whose mass is allowed with rings too.
_DOTS: Final = ("#8c8c8c", "#303030")
_BANDS: Final = ("#dadada", "#b0b0b0")
_BODY: Final[dict[Silicone, str]] = {"dragon-skin-10": SKY, "dragon-skin-30": ORANGE}
_HOLLOW: Final[dict[str, Any]] = {"linestyle": "none", "fillstyle": "none"}
# Hollow, so that none hides another.
_PRINTED: Final[dict[str, dict[str, Any]]] = {
    "paper: closed form (fitted)": {"color": BLACK, "marker": "+", "markersize": 13.0, "markeredgewidth": 2.2},
    "paper: ANSYS": {"color": PURPLE, "marker": "d", "markersize": 9.0, "markeredgewidth": 2.0, **_HOLLOW},
    "paper: experiment": {"color": BLACK, "marker": "o", "markersize": 10.0, "markeredgewidth": 1.8, **_HOLLOW},
}
# Planes of the dimensions: what is drawn over R_p.
_PLANES: Final = {
    "larger_root_radius_mm": "larger $R_i$, mm",
    "half_pitch_mm": "half pitch $e$, mm",
    "convolutions": "convolutions $n$",
}
# Unfolding pressures span three decades.
_LOGARITHMIC: Final = ("unfolding_pressure_kpa", "rest_length_mm", "tip_force_n")


def draw_members(path: Path, found: Fit) -> None:
    """Draw all sets that fit in three planes of their dimensions, a column per choice of silicones.

    Parameters
    ----------
    path
        The PNG to write.
    found
        Its members; colours say the worst error, %.
    """
    members, picks = found.members, found.picks.sets
    choices = [s for s in np.unique(members.silicone, axis=0) if np.count_nonzero(of_silicone(members, s)) > 1]
    scale = Normalize(0.0, 100.0 * WITHIN)
    look: dict[str, Any] = {"norm": scale, "cmap": "viridis", "s": 11.0, "zorder": 2}
    with figure_file(path, 1.0 + 2.0 * len(choices), 7.6) as figure:
        every = figure.subplots(len(_PLANES), len(choices), sharex=True, sharey="row", squeeze=False)
        for column, silicone in zip(every.T, choices, strict=True):
            part = members.take(of_silicone(members, silicone))
            # the best last, on top
            part = part.take(np.argsort(-part.worst_error))
            column[0].set_title(f"Dragon Skin\n{silicones_text(silicone)}\n{len(part)} sets", fontsize=10)
            for axes, name in zip(column, _PLANES, strict=True):
                axes.scatter(part.crest_radius_mm, getattr(part, name), c=100.0 * part.worst_error, **look)
                for k in np.flatnonzero(of_silicone(picks, silicone)):
                    axes.plot(picks.crest_radius_mm[k], getattr(picks, name)[k], zorder=4, **white_edged(**_PICKS[k]))
                grid(axes)
            column[-1].set_xlabel("$R_p$, mm")
        for axes, label in zip(every[:, 0], _PLANES.values(), strict=True):
            axes.set_ylabel(label)
        figure.colorbar(ScalarMappable(scale, "viridis"), ax=every, label="worst error, %", shrink=0.5, pad=0.02)
        figure.legend(handles=_pick_entries(), ncols=3, **BELOW)


def draw_spread(path: Path, found: Fit, predicted: Sequence[Prediction]) -> None:
    """Draw what all sets that fit predict where they were not fitted, a panel per quantity, a strip per actuator.

    Parameters
    ----------
    path
        The PNG to write.
    found
        Its members.
    predicted
        Numbers of members and picked sets, in their own units.
    """
    with_rings = found.members_allowed_with_rings
    columns = 3
    rows = -(-len(predicted) // columns)
    with figure_file(path, 11.0, 0.8 + 2.45 * rows) as figure:
        every = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for axes, prediction in zip(every.ravel(), predicted, strict=False):
            _draw_strips(axes, prediction, with_rings)
        for axes in every.ravel()[len(predicted) :]:
            axes.set_visible(False)
        every[0, 0].set_yticks(range(len(ACTUATORS)), [_with_math(name) for name in ACTUATORS])
        every[0, 0].set_ylim(len(ACTUATORS) - 0.5, -0.5)
        dots = [
            entry(label, linestyle="none", marker="o", markersize=5.0, color=colour)
            for colour, label in zip(_DOTS, ("fits, without", "fits, mass allowed with rings too"), strict=True)
        ]
        figure.legend(handles=[*_pick_entries(), *reversed(dots)], ncols=5, **BELOW)


def _draw_strips(axes: Axes, prediction: Prediction, with_rings: BoolArray) -> None:
    q = prediction.quantity
    # a fixed seed: the same picture from the same numbers
    jitter = np.random.default_rng(0).uniform(-0.28, 0.28, len(with_rings))
    for j in range(len(ACTUATORS)):
        for mask, colour in zip((~with_rings, with_rings), _DOTS, strict=True):
            look: dict[str, Any] = {"s": 3.0, "color": colour, "linewidths": 0.0, "alpha": 0.55, "zorder": 2}
            axes.scatter(prediction.members[mask, j], j + jitter[mask], **look)
        for k, style in enumerate(_PICKS):
            # above each other, or equal numbers would hide
            axes.plot(prediction.picks[k, j], j + 0.22 * (k - 1), zorder=4, **white_edged(**style))
    axes.set_title(q.label, fontsize=10)
    axes.set_xlabel("" if q.unit == "1" else q.unit)
    if q.name in _LOGARITHMIC:
        axes.set_xscale("log")
        _label_decades(axes, prediction.members)
    grid(axes, "x")


def draw_paths(path: Path, found: Fit) -> None:
    """Draw elongation (mm) over pressure (kPa) of each actuator: all that fit, the picked sets, the printed numbers."""
    pressures = np.linspace(0.0, PRINTED_PRESSURE_KPA, 41)
    curves = np.stack([tip_mm(found.members, p) for p in pressures])  # (p, m, 4)
    picks = np.stack([tip_mm(found.picks.sets, p) for p in pressures])
    with figure_file(path, 11.0, 3.5) as figure:
        every = figure.subplots(1, len(ACTUATORS))
        for j, axes in enumerate(every):
            for part, colour in zip((curves, curves[:, found.members_allowed_with_rings]), _BANDS, strict=True):
                ends = part[:, :, j].min(axis=1), part[:, :, j].max(axis=1)
                axes.fill_between(pressures, *ends, color=colour, linewidth=0.0, zorder=1)
            for k, (style, dashes) in enumerate(zip(_PICKS, _DASHES, strict=True)):
                axes.plot(pressures, picks[:, k, j], color=style["color"], linestyle=dashes, linewidth=1.8, zorder=3)
            printed = printed_mm(found.sets[0].actuators[j])
            for value, style in zip(printed.values(), _PRINTED.values(), strict=True):
                axes.plot(PRINTED_PRESSURE_KPA, value, zorder=4, clip_on=False, **style)
            axes.set_title(_with_math(ACTUATORS[j]), fontsize=10)
            axes.set(xlabel="cavity pressure, kPa", xlim=(0.0, PRINTED_PRESSURE_KPA))
            axes.set_ylim(bottom=0.0)
            grid(axes)
        every[0].set_ylabel("elongation, corrected chain, mm")
        figure.legend(handles=_path_entries(), ncols=4, **BELOW)


def _path_entries() -> list[Line2D | Patch]:
    bands = ("all that fit", "mass allowed with rings too")
    return [
        *(
            entry(name, color=style["color"], linestyle=dashes)
            for style, dashes, name in zip(_PICKS, _DASHES, SET_NAMES, strict=True)
        ),
        *(Patch(color=colour, label=label) for colour, label in zip(_BANDS, bands, strict=True)),
        *(entry(label, **{"linestyle": "none", **style}) for label, style in _PRINTED.items()),
    ]


def draw_outlines(path: Path, found: Fit) -> None:
    """Draw the halved bodies of the picked sets at rest, to one scale, mm."""
    longest = max(shape_of(scene_of(of_set.actuators[0])).cavity_length_mm for of_set in found.sets)
    with figure_file(path, 11.0, 4.9) as figure:
        every = figure.subplots(len(ACTUATORS), len(SET_NAMES), sharex=True, sharey=True)
        for column, of_set in zip(every.T, found.sets, strict=True):
            for axes, actuator in zip(column, of_set.actuators, strict=True):
                scene = scene_of(actuator)
                draw_half_outline(axes, shape_of(scene), scene.rings.height_mm, _BODY[actuator.silicone])
                axes.set(aspect="equal", xlim=(-1.0, longest + 6.0), ylim=(0.0, 20.0))
                axes.set_title(actuator.name, fontsize=9)
            column[0].set_title(f"{of_set.name}\n{of_set.actuators[0].name}", fontsize=9)
            column[-1].set_xlabel("axis, mm")
        for axes in every[:, 0]:
            axes.set_ylabel("r, mm")
        bodies = [Patch(color=colour, label=SILICONES[silicone]) for silicone, colour in _BODY.items()]
        figure.legend(handles=[*bodies, Patch(color=GREY, label="rings")], ncols=3, **BELOW)


def _pick_entries() -> list[Line2D]:
    looks = (white_edged(**style) for style in _PICKS)
    return [entry(name, linestyle="none", **look) for name, look in zip(SET_NAMES, looks, strict=True)]


def _with_math(name: str) -> str:
    return name.replace("R_i", "$R_i$")


def _label_decades(axes: Axes, values: FloatArray) -> None:
    """Plain numbers at 1, 2 and 5 of each decade, or at the decades alone where that would be too many."""
    decades = 10.0 ** np.arange(np.floor(np.log10(values.min())), np.ceil(np.log10(values.max())))
    ticks = (decades[:, None] * np.array([1.0, 2.0, 5.0])).ravel()
    ticks = ticks[(ticks >= 0.9 * values.min()) & (ticks <= 1.1 * values.max())]
    if len(ticks) > 6:
        ticks = ticks[ticks == 10.0 ** np.round(np.log10(ticks))]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
