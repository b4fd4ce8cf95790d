"""Pictures of the study of the unprinted dimensions: sets that fit, what they predict, outlines of the picked ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from analytical.arrays import FloatArray
from analytical.bellows.fit.members import SILICONES, WITHIN, Members, tip_mm
from analytical.bellows.paper import PRINTED, PRINTED_PRESSURE_KPA, PaperActuator
from meshes.bellows import BellowsShape, cap_band, corner_band, wall_segments
from studies.dimensions.fit import ACTUATORS, DimensionStudy, Prediction
from studies.dimensions.scenes import scene_of
from studies.dimensions.tables import SET_NAMES
from studies.report.style import BELOW, BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, figure_file, grid
from studies.scene.bellows import shape_of

# Of the picked sets: told apart by shape as well as by colour.
_PICKS: Final[tuple[dict[str, Any], ...]] = (
    {"color": VERMILION, "marker": "*", "markersize": 15.0},
    {"color": BLUE, "marker": "D", "markersize": 7.5},
    {"color": GREEN, "marker": "s", "markersize": 8.0},
)
_ALL: Final = "#8c8c8c"
_ALSO_WITH_RINGS: Final = "#303030"
_BODY: Final = {"dragon-skin-10": SKY, "dragon-skin-30": ORANGE}
# Hollow, so that none hides another.
_PRINTED: Final[dict[str, dict[str, Any]]] = {
    "paper: closed form (fitted)": {"color": BLACK, "marker": "+", "markersize": 13.0, "markeredgewidth": 2.2},
    "paper: ANSYS": {"color": PURPLE, "marker": "d", "markersize": 9.0, "fillstyle": "none", "markeredgewidth": 2.0},
    "paper: experiment": {
        "color": BLACK,
        "marker": "o",
        "markersize": 10.0,
        "fillstyle": "none",
        "markeredgewidth": 1.8,
    },
}
# Unfolding pressures span three decades.
_LOGARITHMIC: Final = ("unfolding_pressure_kpa", "rest_length_mm", "tip_force_n")


def draw_members(path: Path, study: DimensionStudy) -> None:
    """Draw all sets that fit in three planes of their dimensions, a column per choice of silicones.

    Parameters
    ----------
    path
        The PNG to write.
    study
        Its members; colours say the worst error, %.
    """
    members = study.members
    choices = [s for s in np.unique(members.silicone, axis=0) if np.count_nonzero(_of(members, s)) > 1]
    planes = (
        ("larger_root_radius_mm", "larger $R_i$, mm"),
        ("half_pitch_mm", "half pitch $e$, mm"),
        ("convolutions", "convolutions $n$"),
    )
    scale = Normalize(0.0, 100.0 * WITHIN)
    with figure_file(path, 1.0 + 2.0 * len(choices), 7.6) as figure:
        places = figure.subplots(len(planes), len(choices), sharex=True, sharey="row", squeeze=False)
        for column, silicone in zip(places.T, choices, strict=True):
            part = members.take(_of(members, silicone))
            # the best last, on top
            part = part.take(np.argsort(-part.worst_error))
            names = ", ".join(SILICONES[s].removeprefix("dragon-skin-") for s in silicone)
            column[0].set_title(f"Dragon Skin\n{names}\n{len(part)} sets", fontsize=10)
            for axes, (name, _) in zip(column, planes, strict=True):
                axes.scatter(
                    part.crest_radius_mm,
                    getattr(part, name),
                    c=100.0 * part.worst_error,
                    norm=scale,
                    cmap="viridis",
                    s=11.0,
                    zorder=2,
                )
                for k in np.flatnonzero(np.all(study.picks.sets.silicone == silicone, axis=1)):
                    x, y = study.picks.sets.crest_radius_mm[k], getattr(study.picks.sets, name)[k]
                    axes.plot(x, y, zorder=4, markeredgecolor="white", markeredgewidth=1.2, **_PICKS[k])
                grid(axes)
            column[-1].set_xlabel("$R_p$, mm")
        for axes, (_, label) in zip(places[:, 0], planes, strict=True):
            axes.set_ylabel(label)
        figure.colorbar(ScalarMappable(scale, "viridis"), ax=places, label="worst error, %", shrink=0.5, pad=0.02)
        figure.legend(handles=_pick_handles(), ncols=3, **BELOW)


def draw_spread(path: Path, study: DimensionStudy, predicted: Sequence[Prediction]) -> None:
    """Draw what all sets that fit predict where they were not fitted, a panel per quantity, a strip per actuator.

    Parameters
    ----------
    path
        The PNG to write.
    study
        Its members.
    predicted
        Numbers of members and picked sets, in their own units.
    """
    with_rings = study.members_allowed_with_rings
    # a fixed seed: the same picture from the same numbers
    jitter = np.random.default_rng(0).uniform(-0.28, 0.28, len(with_rings))
    columns = 3
    rows = -(-len(predicted) // columns)
    with figure_file(path, 11.0, 0.8 + 2.45 * rows) as figure:
        places = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for axes, prediction in zip(places.ravel(), predicted, strict=False):
            q = prediction.quantity
            for j in range(len(ACTUATORS)):
                for mask, colour in ((~with_rings, _ALL), (with_rings, _ALSO_WITH_RINGS)):
                    look = {"s": 3.0, "color": colour, "linewidths": 0.0, "alpha": 0.55, "zorder": 2}
                    axes.scatter(prediction.members[mask, j], j + jitter[mask], **look)
                for k, style in enumerate(_PICKS):
                    look = {"zorder": 4, "markeredgecolor": "white", "markeredgewidth": 1.0, **style}
                    # above each other, or equal numbers would hide
                    axes.plot(prediction.picks[k, j], j + 0.22 * (k - 1), **look)
            axes.set_title(q.label, fontsize=10)
            axes.set_xlabel("" if q.unit == "1" else q.unit)
            if q.name in _LOGARITHMIC:
                axes.set_xscale("log")
                _label_decades(axes, prediction.members)
            grid(axes, axis="x")
        for axes in places.ravel()[len(predicted) :]:
            axes.set_visible(False)
        places[0, 0].set_yticks(range(len(ACTUATORS)), [_with_math(name) for name in ACTUATORS])
        places[0, 0].set_ylim(len(ACTUATORS) - 0.5, -0.5)
        dots = [
            Line2D([], [], linestyle="none", marker="o", markersize=5.0, color=colour, label=label)
            for colour, label in ((_ALSO_WITH_RINGS, "fits, mass allowed with rings too"), (_ALL, "fits, without"))
        ]
        figure.legend(handles=[*_pick_handles(), *dots], ncols=5, **BELOW)


def draw_paths(path: Path, study: DimensionStudy) -> None:
    """Draw elongation (mm) over pressure (kPa) of each actuator: all that fit, the picked sets, the printed numbers."""
    pressures = np.linspace(0.0, PRINTED_PRESSURE_KPA, 41)
    members, with_rings = study.members, study.members_allowed_with_rings
    curves = np.stack([tip_mm(members, p) for p in pressures])  # (p, m, 4)
    picks = np.stack([tip_mm(study.picks.sets, p) for p in pressures])
    with figure_file(path, 11.0, 3.5) as figure:
        places = figure.subplots(1, len(ACTUATORS))
        for j, axes in enumerate(places):
            for of, colour in ((curves[:, :, j], "#dadada"), (curves[:, with_rings, j], "#b0b0b0")):
                axes.fill_between(pressures, of.min(axis=1), of.max(axis=1), color=colour, linewidth=0.0, zorder=1)
            for k, style in enumerate(_PICKS):
                dashes = ("-", "--", ":")[k]
                axes.plot(pressures, picks[:, k, j], color=style["color"], linestyle=dashes, linewidth=1.8, zorder=3)
            for value_cm, style in zip(_printed_cm(j), _PRINTED.values(), strict=True):
                axes.plot(PRINTED_PRESSURE_KPA, 10.0 * value_cm, zorder=4, clip_on=False, **style)
            axes.set_title(_with_math(ACTUATORS[j]), fontsize=10)
            axes.set_xlabel("cavity pressure, kPa")
            axes.set_xlim(0.0, PRINTED_PRESSURE_KPA)
            axes.set_ylim(bottom=0.0)
            grid(axes)
        places[0].set_ylabel("elongation, corrected chain, mm")
        handles: list[Any] = [
            Line2D([], [], color=style["color"], linestyle=dashes, label=name)
            for style, dashes, name in zip(_PICKS, ("-", "--", ":"), SET_NAMES, strict=True)
        ]
        handles += [
            Patch(color="#dadada", label="all that fit"),
            Patch(color="#b0b0b0", label="mass allowed with rings too"),
        ]
        handles += [Line2D([], [], linestyle="none", label=label, **style) for label, style in _PRINTED.items()]
        figure.legend(handles=handles, ncols=4, **BELOW)


def draw_outlines(path: Path, study: DimensionStudy) -> None:
    """Draw the halved bodies of the picked sets at rest, to one scale, mm."""
    longest = max(shape_of(scene_of(of_set[0])).cavity_length_mm for of_set in study.actuators)
    with figure_file(path, 11.0, 4.9) as figure:
        places = figure.subplots(len(ACTUATORS), len(SET_NAMES), sharex=True, sharey=True)
        for k, of_set in enumerate(study.actuators):
            for axes, actuator in zip(places[:, k], of_set, strict=True):
                _draw_body(axes, actuator)
                axes.set_aspect("equal")
                axes.set_xlim(-1.0, longest + 6.0)
                axes.set_ylim(0.0, 20.0)
                axes.set_title(actuator.name, fontsize=9)
            places[0, k].set_title(f"{SET_NAMES[k]}\n{of_set[0].name}", fontsize=9)
            places[-1, k].set_xlabel("axis, mm")
        for axes in places[:, 0]:
            axes.set_ylabel("r, mm")
        handles = [
            Patch(color=colour, label=name.replace("dragon-skin-", "Dragon Skin ")) for name, colour in _BODY.items()
        ]
        figure.legend(
            handles=[*handles, Patch(color="#777777", label="rings")],
            ncols=3,
            **BELOW,
        )


def _draw_body(axes: Any, actuator: PaperActuator) -> None:
    """Half a section: wall, cap and rings; the axis is horizontal."""
    scene = scene_of(actuator)
    shape = shape_of(scene)
    for inner, outer in _bands(shape):
        points = np.vstack([inner, outer[::-1]])[:, ::-1]  # (r, z) to (z, r)
        axes.add_patch(Polygon(points, facecolor=_BODY[actuator.silicone], edgecolor="none", antialiased=False))
    for centre in shape.crest_positions_mm:
        corner = (centre - 0.5 * shape.seat_mm, shape.seat_radius_mm)
        axes.add_patch(Rectangle(corner, shape.seat_mm, scene.rings.height_mm, facecolor="#777777", edgecolor="none"))


def _bands(shape: BellowsShape) -> list[tuple[FloatArray, FloatArray]]:
    """Cavity side and outside of every piece of the body, (r, z), mm."""
    along = np.linspace(0.0, 1.0, 21)
    pieces = [segment.band(along) for segment in wall_segments(shape)]
    return [*pieces, corner_band(shape, along), cap_band(shape, along)]


def _of(members: Members, silicone: FloatArray) -> Any:
    return np.all(members.silicone == silicone, axis=1)


def _printed_cm(actuator: int) -> tuple[float, float, float]:
    """Printed elongations in the order of `_PRINTED`, cm."""
    row = PRINTED[actuator]
    return row.closed_form_cm, row.ansys_cm, row.experiment_cm


def _pick_handles() -> list[Line2D]:
    return [
        Line2D([], [], linestyle="none", markeredgecolor="white", label=name, **style)
        for name, style in zip(SET_NAMES, _PICKS, strict=True)
    ]


def _with_math(name: str) -> str:
    return name.replace("R_i", "$R_i$")


def _label_decades(axes: Any, values: FloatArray) -> None:
    """Ticks at 1, 2 and 5 of each decade, as plain numbers."""
    decades = 10.0 ** np.arange(np.floor(np.log10(values.min())), np.ceil(np.log10(values.max())))
    ticks = (decades[:, None] * np.array([1.0, 2.0, 5.0])).ravel()
    ticks = ticks[(ticks >= 0.9 * values.min()) & (ticks <= 1.1 * values.max())]
    if len(ticks) > 6:
        ticks = ticks[ticks == 10.0 ** np.round(np.log10(ticks))]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
