"""How figures look: colours, the style of each model, grids, legends, and the file a figure is written to."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

DPI = 150

# Okabe and Ito: told apart by colour-blind readers; shape and dash say the same once more.
BLACK, ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)

GREY = "#777777"
# Paul Tol's: beside all of the above where they do not suffice.
WINE = "#882255"
_STYLES: dict[str, dict[str, Any]] = {
    "closed_form": {"color": ORANGE, "linestyle": "--", "marker": "^"},
    "closed_form_printed": {"color": SKY, "linestyle": "-.", "marker": "<"},
    "closed_form_balanced": {"color": GREEN, "linestyle": "-", "marker": "o"},
    "closed_form_seat": {"color": GREY, "linestyle": ":", "marker": "v"},
    "closed_form_outline": {"color": PURPLE, "linestyle": "--", "marker": ">"},
    "axisymmetric": {"color": BLUE, "linestyle": "-", "marker": "o"},
    "sector": {"color": SKY, "linestyle": "-.", "marker": "h"},
    "full3d": {"color": VERMILION, "linestyle": "none", "marker": "s"},
    "paper_closed_form": {"color": ORANGE, "linestyle": "none", "marker": "P"},
    "paper_ansys": {"color": PURPLE, "linestyle": "none", "marker": "D"},
    "paper_experiment": {"color": BLACK, "linestyle": "none", "marker": "*"},
    "measured": {"color": BLACK, "linestyle": "none", "marker": "o"},
}

OTHERS = (
    {"color": GREY, "linestyle": "--", "marker": "<"},
    {"color": GREY, "linestyle": ":", "marker": ">"},
    {"color": GREY, "linestyle": "-.", "marker": "d"},
)

# Curves that are told apart by nothing but their names.
CURVES = tuple(
    {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.3}
    for colour, marker in zip((BLUE, VERMILION, GREEN, PURPLE, ORANGE, BLACK), "os^vDP", strict=True)
)

# Rigid rings, which are in no mesh.
RIGID_COLOUR, RIGID_EDGE = "#d8d8d8", "#303030"
RIGID: dict[str, Any] = {"facecolor": RIGID_COLOUR, "edgecolor": RIGID_EDGE, "linewidth": 0.8}
# A line that is read over whatever lies below it.
HALO = [withStroke(linewidth=3.0, foreground="white")]
# Where a legend stands: beside or inside axes; below or above all axes of a figure.
BESIDE: dict[str, Any] = {
    "loc": "upper left",
    "bbox_to_anchor": (1.01, 1.0),
    "borderaxespad": 0.0,
    "frameon": False,
}
INSIDE: dict[str, Any] = {"frameon": False}
BELOW: dict[str, Any] = {"loc": "outside lower center", "frameon": False}
ABOVE: dict[str, Any] = {"loc": "outside upper center", "frameon": False}


def style_of(model: str) -> dict[str, Any]:
    """Colour, dash and marker of a model; empty if it has none of its own."""
    return dict(_STYLES.get(model, {}))


def edge_of(model: str) -> str:
    """Colour round a marker: printed numbers are told from computed ones by black."""
    return "black" if model.startswith("paper_") else "white"


def white_edged(size: float = 6.0, **look: Any) -> dict[str, Any]:
    """Look of a marker that is told from those below it by its white edge."""
    return {"markersize": size, **look, "markeredgecolor": "white", "markeredgewidth": 0.7}


def entry(label: str, **look: Any) -> Line2D:
    """Entry of a legend for what has no line of its own."""
    return Line2D([], [], label=label, **look)


def grid(axes: Axes, axis: Literal["both", "x", "y"] = "both", which: Literal["major", "both"] = "major") -> None:
    """A pale grid behind everything."""
    axes.grid(axis=axis, which=which, color="#e4e4e4")
    axes.set_axisbelow(True)


@contextmanager
def figure_file(path: Path, width_in: float, height_in: float, dpi: int = DPI) -> Iterator[Figure]:
    """A figure that is written to ``path`` on leaving; no state shared with the caller's matplotlib."""
    figure = Figure(figsize=(width_in, height_in), dpi=dpi, layout="constrained")
    FigureCanvasAgg(figure)
    yield figure
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=dpi)
