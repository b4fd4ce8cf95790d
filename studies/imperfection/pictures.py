"""Pictures of the imperfection study: bend and elongation over pressure, and the most bent shapes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from studies.imperfection.bodies import SHARES, Actuator, Body
from studies.report.labels import level_label
from studies.report.pictures.bent import Bent, draw_bent
from studies.report.style import ABOVE, BLACK, BLUE, ORANGE, VERMILION, figure_file
from studies.results.run_files import load_state
from studies.scene.bellows import core_shift_mm
from studies.scene.meshes import scene_body, scene_meridian

LOOKS: Final = {0.0: (BLACK, "o"), 0.05: (ORANGE, "s"), 0.10: (VERMILION, "D")}


def draw_bends(path: Path, solved: Sequence[tuple[Actuator, Sequence[Body]]]) -> None:
    """Draw bend and change of the elongation over pressure, a column of axes per actuator."""
    with figure_file(path, 4.2 * len(solved), 6.0) as figure:
        grid = figure.subplots(2, len(solved), squeeze=False, sharex="col")
        for (above, below), (actuator, bodies) in zip(grid.T, solved, strict=True):
            pressures, centred = actuator.pressures_kpa, bodies[0]
            for body in bodies:
                bends = [body.value("tip_bend_deg", p) for p in pressures]
                if body.level != centred.level:
                    label = f"the same, {level_label(body.level.name)}"
                    above.plot(pressures, bends, "+" if body.level.meridian > 1 else "x", color=BLUE, label=label)
                    continue
                colour, marker = LOOKS[body.share]
                label = f"core off by {100.0 * body.share:g} % of t"
                above.plot([0.0, *pressures], [0.0, *bends], color=colour, marker=marker, label=label)
                if body.share:
                    change = [100.0 * body.longer_mm(centred, p) / centred.value("tip_mm", p) for p in pressures]
                    below.plot(pressures, change, color=colour, marker=marker)
            above.set_title(actuator.name, fontsize=10)
            below.set_xlabel("pressure, kPa")
        grid[0][0].set_ylabel("bend of the tip, degree")
        grid[1][0].set_ylabel("change of the elongation, %")
        figure.legend(*grid[0][0].get_legend_handles_labels(), **ABOVE, ncols=2, fontsize=8)


def draw_shapes(path: Path, bodies: Sequence[Body]) -> bool:
    """Draw the highest pressures that the centred and the most eccentric core reached; False if there are none."""
    states = []
    for body in (bodies[0], bodies[len(SHARES) - 1]):
        scene, pressure = body.scene, max(body.poses, default=0.0)
        if saved := load_state(body.folder, body.run.summary.content_hash, 1e-3 * pressure):
            meridian = scene_meridian(scene, body.level.meridian)
            solid = scene_body(meridian, "full3d", body.level.around, core_shift_mm(scene))
            label = f"{scene.name}: core off by {100.0 * body.share:g} % of t, {pressure:g} kPa"
            states.append(Bent(label, scene, meridian, solid, saved[0]))
    if states:
        draw_bent(path, states)
    return bool(states)
