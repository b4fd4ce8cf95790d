"""The outline with its letters: ends and two folds, as moulded and near the zigzag of the paper's figure 2."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from studies.paper.setup.sizes import ZIGZAG, scene_of
from studies.report.pictures.lettered import FONT, draw_lettered
from studies.report.style import figure_file

# Drawn of all folds, so that the letters have room.
FOLDS: Final = 2


def draw_outlines(path: Path, name: str) -> str:
    """Draw an actuator's half section with letters, as moulded beside the zigzag outline, to one scale, mm."""
    found = {"as moulded": scene_of(name), "zigzag outline": scene_of(name, ZIGZAG)}
    with figure_file(path, 11.0, 3.7) as figure:
        for axes, (title, scene) in zip(figure.subplots(1, 2, sharey=True), found.items(), strict=True):
            draw_lettered(axes, scene, FOLDS)
            fillet, seat = scene.geometry.fillet_mm, scene.rings.seat_mm
            axes.set_title(f"{title}: fillet {fillet:g} mm, seat {seat:g} mm", fontsize=FONT)
    return ""
