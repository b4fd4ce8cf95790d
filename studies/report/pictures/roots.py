"""Pictures of fields at a root of the bellows, on the deformed meridian, from axisymmetric states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Normalize
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from meshes.gaps import outlines
from meshes.solid import REGIONS, FloatArray, IntArray
from solvers.vtu import pressure_at_nodes
from studies.planning.levels import fineness
from studies.report.pictures.stills import RingBox
from studies.report.style import BELOW, RIGID, RIGID_EDGE, entry, figure_file
from studies.results.measures import find_places, largest_stretches
from studies.results.run_files import load_state
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.meshes import scene_meridian

_WIDTH_IN: Final = 8.2
_TICK_POINTS: Final = 8.0
_GAP_MM: Final = 0.6
_ROUND_OFF_MM: Final = 1e-6
# A skin of a tenth of a millimetre is to be seen: three pixels, beside an outline of one.
_DPI: Final = 280
_OUTLINE_POINTS: Final = 0.25
_STRETCH_COLOURS, _STRESS_COLOURS = "YlOrRd", "YlGnBu"
# Bands of mean stress: one of compression, then doubling, since thin walls carry many times the stress of thick ones.
_FIRST_BAND_KPA: Final = 50.0
_STRESS: Final = "mean stress, kPa, tension positive; bands double"
_UNDEFORMED = "#8c8c8c"
# A cell as flat triangles of its corner, mid-edge and middle nodes, by its number of nodes.
_FLAT: Final[dict[int, IntArray]] = {
    6: np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]]),
    9: np.array(
        [[0, 4, 8], [4, 1, 8], [1, 6, 8], [6, 3, 8], [3, 7, 8], [7, 2, 8], [2, 5, 8], [5, 0, 8]],
    ),
}


@dataclass(frozen=True, eq=False)
class RootPanel:
    """The wall round the middle root from the middle of one ring to that of the next, in one state.

    Attributes
    ----------
    label
        Text beside it.
    points_mm
        Axial position from the middle between the two rings, and radius, of the deformed nodes, shape (n, 2), mm.
    triangles
        Nodes of flat triangles, shape (m, 3).
    stretch, mean_stress_kpa
        Largest principal stretch and mean stress p (tension positive), kPa, at the nodes, shape (n,).
    trusted
        True at nodes half a millimetre or more from the seats' edges, where no peak grows with the mesh, shape (n,).
    undeformed_mm
        Outlines of the wall without pressure, as `points_mm`, each of shape (k, 2), mm.
    rings
        The two rigid rings; drawn as far as the wall is.
    """

    label: str
    points_mm: FloatArray
    triangles: IntArray
    stretch: FloatArray
    mean_stress_kpa: FloatArray
    trusted: NDArray[np.bool_]
    undeformed_mm: tuple[FloatArray, ...]
    rings: tuple[RingBox, ...]


def root_panel(
    scene: BellowsScene, run: Run, run_folder: Path, pressure_kpa: float, label: str = ""
) -> RootPanel | None:
    """The middle root of a scene in a state of one of its axisymmetric runs.

    Parameters
    ----------
    scene, run, run_folder
        A bellows, its run, and where that is kept.
    pressure_kpa
        A requested pressure, kPa.
    label
        Text beside it; default wall and root radius.

    Returns
    -------
    RootPanel or None
        None if the state is not there.
    """
    saved = load_state(run_folder, run.summary.content_hash, 1e-3 * pressure_kpa)
    if saved is None:
        return None
    state, _ = saved
    refinement = fineness(run.summary.level)
    mesh, shape = scene_meridian(scene, refinement), shape_of(scene)
    first = (scene.geometry.convolutions - 1) // 2
    centres = shape.crest_positions_mm[first : first + 2]
    shifts = np.zeros(2)
    rings: tuple[RingBox, ...] = ()
    if scene.rings.model == "rigid":
        shifts = state.bodies_mm[first : first + 2, 0]
        away = 0.5 * np.diff(centres + shifts)[0]
        size = (shape.seat_radius_mm, scene.rings.seat_mm, scene.rings.height_mm)
        rings = (RingBox(-away, *size), RingBox(away, *size))
    else:
        seats = np.column_stack([np.full(2, shape.seat_radius_mm), centres])
        crests = [int(np.argmin(np.linalg.norm(mesh.points - seat, axis=1))) for seat in seats]
        shifts = state.displacement_mm[crests, 1]
    low, high = centres[0] - _ROUND_OFF_MM, centres[1] + _ROUND_OFF_MM
    inside = np.all((mesh.points[mesh.cells, 1] > low) & (mesh.points[mesh.cells, 1] < high), axis=1)
    cells = mesh.cells[inside & (mesh.regions != REGIONS["ring"])]
    used, triangles = np.unique(cells[:, _FLAT[cells.shape[1]]].reshape(-1, 3), return_inverse=True)
    deformed = mesh.points + state.displacement_mm - np.array([0.0, np.mean(centres + shifts)])
    undeformed = mesh.points - np.array([0.0, np.mean(centres)])
    lines = []
    for outline in outlines(mesh):
        axial = mesh.points[outline.nodes, 1]
        lines.append(undeformed[outline.nodes[(axial > low) & (axial < high)]][:, ::-1])
    g, places = scene.geometry, find_places(scene, refinement)
    return RootPanel(
        label=label or f"t = {g.wall_mm:g} mm, $R_i$ = {g.root_radius_mm:g} mm",
        points_mm=deformed[used][:, ::-1],
        triangles=triangles.reshape(-1, 3),
        stretch=largest_stretches(places, state.displacement_mm)[used],
        mean_stress_kpa=1e3 * pressure_at_nodes(mesh, state)[used],
        trusted=~places.near_edge[used],
        undeformed_mm=tuple(lines),
        rings=rings,
    )


def draw_root_fields(path: Path, panels: Sequence[RootPanel]) -> str:
    """Draw stretch on the left and mean stress on the right, a row per panel, all to one scale in mm.

    Each row has a scale of stretch of its own, for thick walls stretch by a fraction of what thin ones do.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        From top to bottom.

    Returns
    -------
    str
        Empty, or why there is no picture.
    """
    if not panels:
        return "no state was kept"
    boxes = np.array([_box(panel) for panel in panels])
    width = 2.0 * np.abs(boxes[:, :2]).max() + 2.0 * _GAP_MM
    heights = boxes[:, 3] - boxes[:, 2] + 2.0 * _GAP_MM
    bands = _bands(max(_largest(panel, panel.mean_stress_kpa) for panel in panels))
    stress = BoundaryNorm(bands, 256, extend="both")
    inch_per_mm = 0.36 * _WIDTH_IN / width
    height_in = float(inch_per_mm * heights.sum() + 0.75 * len(panels) + 0.7)
    with figure_file(path, _WIDTH_IN, height_in, dpi=_DPI) as figure:
        grid = figure.subplots(len(panels), 2, squeeze=False, height_ratios=heights)
        for (left, right), panel, box in zip(grid, panels, boxes, strict=True):
            stretch = Normalize(1.0, _largest(panel, panel.stretch))
            for axes, field, colours, norm, extend in (
                (left, panel.stretch, _STRETCH_COLOURS, stretch, "max"),
                (right, panel.mean_stress_kpa, _STRESS_COLOURS, stress, "both"),
            ):
                _draw(axes, panel, field, colours, norm)
                axes.set_xlim(-0.5 * width, 0.5 * width)
                axes.set_ylim(box[2] - _GAP_MM, box[3] + _GAP_MM)
                axes.set_xlabel("axial, from the middle of the root, mm", fontsize=_TICK_POINTS)
                # beside the axes and as high: in the layout it would move them
                beside = axes.inset_axes((1.02, 0.0, 0.03, 1.0))
                bar = figure.colorbar(ScalarMappable(norm, colours), cax=beside, extend=extend)
                bar.ax.tick_params(labelsize=_TICK_POINTS - 1.0)
            left.set_title(panel.label, loc="left", fontsize=10.0)
            left.set_ylabel("radius, mm", fontsize=_TICK_POINTS)
        for axes, title in zip(grid[0], ("largest principal stretch", _STRESS), strict=True):
            axes.set_title(title, loc="right", fontsize=_TICK_POINTS + 1.0)
        entries: list[Any] = [entry("without pressure", color=_UNDEFORMED, linewidth=0.9)]
        if any(panel.rings for panel in panels):
            entries.append(Patch(**RIGID, label="half a rigid ring"))
        figure.legend(handles=entries, ncols=2, fontsize=9.0, **BELOW)
    return ""


def _draw(axes: Axes, panel: RootPanel, field: FloatArray, colours: str, norm: Normalize) -> None:
    """Draw one field of a panel."""
    look: dict[str, Any] = {"cmap": colours, "norm": norm, "zorder": 3.0}
    if isinstance(norm, BoundaryNorm):
        axes.tricontourf(*panel.points_mm.T, panel.triangles, field, levels=norm.boundaries, extend="both", **look)
    else:
        axes.tripcolor(*panel.points_mm.T, panel.triangles, field, shading="gouraud", **look)
    for line in panel.undeformed_mm:
        axes.plot(*line.T, color=_UNDEFORMED, linewidth=0.9, zorder=2.0)
    for edge in _outer_edges(panel.triangles):
        axes.plot(*panel.points_mm[edge].T, color=RIGID_EDGE, linewidth=_OUTLINE_POINTS, zorder=4.0)
    for ring in panel.rings:
        left = ring.centre_mm - (0.5 * ring.width_mm if ring.centre_mm > 0.0 else 0.0)
        corner = (left, ring.inner_radius_mm)
        axes.add_patch(Rectangle(corner, 0.5 * ring.width_mm, ring.height_mm, **RIGID))
    axes.set_aspect("equal")
    axes.yaxis.set_major_locator(MultipleLocator(5.0))
    axes.tick_params(labelsize=_TICK_POINTS)


def _outer_edges(triangles: IntArray) -> list[IntArray]:
    """Nodes along the boundary of the triangles, a closed line each."""
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(pairs, axis=0, return_counts=True)
    neighbours: dict[int, list[int]] = {}
    for a, b in edges[count == 1].tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    lines = []
    while neighbours:
        start = next(iter(neighbours))
        line = [start]
        while line[-1] in neighbours:
            following = [n for n in neighbours.pop(line[-1]) if n in neighbours]
            line.append(following[0] if following else start)
        lines.append(np.array(line))
    return lines


def _box(panel: RootPanel) -> tuple[float, float, float, float]:
    """Least and largest axial position and radius of all that is drawn, mm."""
    drawn = np.vstack([panel.points_mm, *panel.undeformed_mm])
    highest = max([drawn[:, 1].max(), *(ring.inner_radius_mm + ring.height_mm for ring in panel.rings)])
    return drawn[:, 0].min(), drawn[:, 0].max(), drawn[:, 1].min(), highest


def _bands(highest_kpa: float) -> list[float]:
    """Bounds of the bands of mean stress up to the first beyond the highest, kPa."""
    bounds = [-_FIRST_BAND_KPA, 0.0, _FIRST_BAND_KPA]
    while bounds[-1] < highest_kpa:
        bounds.append(2.0 * bounds[-1])
    return bounds


def _largest(panel: RootPanel, field: FloatArray) -> float:
    """Largest value of a field where meshes agree; nearer to the seats' edges peaks grow with the mesh."""
    return float(field[panel.trusted].max())
