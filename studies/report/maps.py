"""What maps of a change in percent share: bands of colour, their scale, and lines where a sign changes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from studies.report.style import BLUE, HALO, entry

# Orange against purple, told apart by colour-blind readers, white where little changes.
PERCENT_COLOURS: Final = "PuOr"
_BORDER: Final = {"colors": BLUE, "linestyles": "--"}


def percent_bands(bounds: Sequence[float]) -> BoundaryNorm:
    """A colour per interval between bounds, and one for either end beyond."""
    return BoundaryNorm(bounds, 256, extend="both")


def percent_text(value: float, _: int = 0) -> str:
    """A percentage with its sign, for ticks and labels; 0 has none."""
    return f"{value:+g}".replace("-", "\N{MINUS SIGN}") if value else "0"


def colour_scale(figure: Figure, drawn: Any, axes: Any, label: str, bounds: Sequence[float] | None = None) -> None:
    """The scale of colours below all maps; with bounds, those of `percent_bands` are its ticks."""
    bar = figure.colorbar(drawn, ax=axes, location="bottom", aspect=50, shrink=0.7)
    if bounds is not None:
        bar.set_ticks(bounds, labels=[percent_text(bound) for bound in bounds])
    bar.set_label(label)


def mark_change_of_sign(axes: Axes, x: NDArray[Any], y: NDArray[Any], values: NDArray[Any]) -> None:
    """Draw the line at which values, shape (len(y), len(x)), change their sign, if they do; NaN is passed over."""
    if np.any(values > 0.0) and np.any(values < 0.0):
        line = axes.contour(x, y, np.ma.masked_invalid(values), levels=[0.0], **_BORDER)
        line.set(linewidth=1.7, path_effects=HALO)


def change_of_sign(label: str) -> Line2D:
    """The legend's entry of `mark_change_of_sign`."""
    return entry(label, color=BLUE, linestyle="--", linewidth=1.7)
