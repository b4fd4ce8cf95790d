"""Maps of the stress test: a square per cell with the letter of its verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from matplotlib.patches import Patch, Rectangle

from studies.report.style import BESIDE, BLACK, ORANGE, SKY, VERMILION, figure_file
from studies.stability.cells import Axis

# Letter, colour and meaning of each verdict; the letter says it without the colour.
LOOKS: Final[Mapping[str, tuple[str, str, str]]] = {
    "right": ("R", SKY, "right answer: error, %"),
    "refusal": ("N", "#C8C8C8", "named refusal"),
    "stop": ("S", ORANGE, "named stop: share of the load, %"),
    "wrong": ("W", VERMILION, "wrong answer"),
}


@dataclass(frozen=True)
class Square:
    """A cell of a map: its verdict and a number beside the letter, empty for none."""

    row: str
    column: str
    verdict: str
    number: str


def draw_map(path: Path, axis: Axis, squares: Sequence[Square]) -> None:
    """Draw a map to a PNG, rows from the top and columns from the left in the order of the squares."""
    rows = list(dict.fromkeys(square.row for square in squares))
    columns = list(dict.fromkeys(square.column for square in squares))
    with figure_file(path, 3.6 + 0.85 * len(columns), 1.3 + 0.33 * len(rows)) as figure:
        axes = figure.add_subplot()
        for square in squares:
            i, j = rows.index(square.row), columns.index(square.column)
            letter, colour, _ = LOOKS[square.verdict]
            axes.add_patch(Rectangle((j - 0.5, i - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="white", linewidth=1.0))
            text = f"{letter} {square.number}".strip()
            axes.text(j, i, text, ha="center", va="center", fontsize=7.5, color=BLACK)
        axes.set_xlim(-0.5, len(columns) - 0.5)
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_xticks(range(len(columns)), columns)
        axes.set_yticks(range(len(rows)), rows)
        axes.tick_params(length=0)
        axes.set_ylabel(axis.rows)
        axes.set_xlabel(axis.columns)
        shown = {square.verdict for square in squares}
        entries = [
            Patch(facecolor=colour, label=f"{letter}: {meaning}")
            for verdict, (letter, colour, meaning) in LOOKS.items()
            if verdict in shown
        ]
        axes.legend(handles=entries, **BESIDE)
