"""What a 3D view shows of a run: the surface of its body and its rigid rings in every state, from the run's folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from meshes.solid import FloatArray, IntArray
from studies.models.session import SCENE_FILE
from studies.report.pictures.bodies import RING_REGION, body_of, outer_faces
from studies.report.pictures.stills import RingBox, Still
from studies.report.scene_page import ring_boxes
from studies.results.run_files import PATH_FILE, SUMMARY_FILE, field_files, load_state, read_path, read_summary
from studies.scene.bellows import BellowsScene
from studies.scene.load import Scene, kept_scene

if TYPE_CHECKING:
    import pyvista

# By the number of a cell's nodes: ends and middles of the edges from its first corner.
_EDGES: Final = {10: [(1, 4), (2, 6), (3, 7)], 27: [(1, 8), (3, 11), (4, 16)]}
# By the number of a face's nodes: their order seen from the other side.
_TURNED: Final = {6: [0, 2, 1, 5, 4, 3], 9: [0, 3, 2, 1, 7, 6, 5, 4, 8]}


@dataclass(frozen=True, eq=False)
class Surface:
    """Faces of a body by their nodes, counterclockwise seen from outside, shape (faces, 6 or 9).

    Attributes
    ----------
    faces
        First those behind the plane y = 0 of the body at rest, then those before it, then the cut between the two
        as it is seen from the front.
    counts
        How many there are of each.
    rigid
        Whether a face is of a meshed ring, shape (faces,).
    """

    faces: IntArray
    counts: tuple[int, int, int]
    rigid: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ShownState:
    """A state of the surface.

    Attributes
    ----------
    pressure_kpa, tip_mm
        Cavity pressure and elongation at the tip.
    points_mm
        Where the nodes are, shape (nodes, 3).
    stretch
        Largest principal stretch at the nodes.
    rings
        Motions of the rigid rings, shape (rings, 6): displacement, mm, and rotation vector.
    """

    pressure_kpa: float
    tip_mm: float
    points_mm: FloatArray
    stretch: FloatArray
    rings: FloatArray


@dataclass(frozen=True, eq=False)
class View:
    """What a 3D view shows.

    Attributes
    ----------
    name
        Of the scene.
    surface
        The faces.
    states
        In the order of their pressures, the body at rest among them.
    rings
        Rigid rings at rest.
    """

    name: str
    surface: Surface
    states: tuple[ShownState, ...]
    rings: tuple[RingBox, ...]


def read_view(run: Path) -> View | None:
    """What to show of a run; None if it has kept no fields of a body in space."""
    if not all(file.is_file() for file in (run / PATH_FILE, run / SUMMARY_FILE, run.parent / SCENE_FILE)):
        return None
    tips = {row.pressure_kpa: row.tip_mm for row in read_path(run) if row.status == "requested"}
    files = field_files(run, sorted(tips))
    if not files:
        return None
    summary, scene = read_summary(run), kept_scene(run.parent / SCENE_FILE)
    rest = body_of(Still("", next(iter(files.values())), deformed=False))
    rings, motions = _rings(scene, run, summary.content_hash, list(files))
    surface = _surface(rest)
    used, numbers = np.unique(surface.faces, return_inverse=True)
    states = []
    if 0.0 not in files:
        still = np.zeros((len(rings), 6))
        states.append(ShownState(0.0, 0.0, rest.points[used], rest["stretch_max"][used], still))
    for (pressure, file), motion in zip(files.items(), motions, strict=True):
        body = body_of(Still("", file))
        states.append(ShownState(pressure, tips[pressure], body.points[used], body["stretch_max"][used], motion))
    surface = Surface(numbers.reshape(surface.faces.shape), surface.counts, surface.rigid)
    return View(summary.scene, surface, tuple(sorted(states, key=lambda state: state.pressure_kpa)), rings)


def _surface(rest: pyvista.UnstructuredGrid) -> Surface:
    """Outer faces of a body at rest, parted at y = 0 along the faces of its cells."""
    behind = rest.cell_centers().points[:, 1] < 0.0
    outer, owners = outer_faces(rest, np.ones(rest.n_cells, dtype=bool))
    half, half_owners = outer_faces(rest, behind)
    known = {face.tobytes() for face in outer}
    cut = np.array([face.tobytes() not in known for face in half], dtype=bool)
    parts = (outer[behind[owners]], outer[~behind[owners]], half[cut])
    cells = np.concatenate([owners[behind[owners]], owners[~behind[owners]], half_owners[cut]])
    faces = np.concatenate(parts)
    turned = _is_mirrored(rest)[cells][:, None]
    faces = np.where(turned, faces[:, _TURNED[faces.shape[1]]], faces)
    return Surface(faces, (len(parts[0]), len(parts[1]), len(parts[2])), rest["region"][cells] == RING_REGION)


def _is_mirrored(rest: pyvista.UnstructuredGrid) -> NDArray[np.bool_]:
    """Whether the nodes of a cell are numbered as in a mirror, as those of some tetrahedra are."""
    ((_, nodes),) = rest.cells_dict.items()
    ends, middles = np.array(_EDGES[nodes.shape[1]]).T
    at = rest.points[nodes]
    tangents = 4.0 * at[:, middles] - 3.0 * at[:, :1] - at[:, ends]
    return np.asarray(np.linalg.det(tangents) < 0.0)


def _rings(
    scene: Scene, run: Path, content_hash: str, pressures_kpa: Sequence[float]
) -> tuple[tuple[RingBox, ...], list[FloatArray]]:
    """Rigid rings at rest and their motions at each pressure; no rings where a state was not kept."""
    none: list[FloatArray] = [np.zeros((0, 6))] * len(pressures_kpa)
    if not isinstance(scene, BellowsScene):
        return (), none
    rings = ring_boxes(scene, run, content_hash, []).get(0.0, ())
    saved = [load_state(run, content_hash, 1e-3 * pressure) for pressure in pressures_kpa]
    motions = [found[0].bodies_mm[: len(rings)] for found in saved if found is not None]
    if not rings or len(motions) < len(saved) or any(motion.shape != (len(rings), 6) for motion in motions):
        return (), none
    # the solver's rotations are times the arm, the radius of the seat
    scale = np.array([1.0, 1.0, 1.0, *3 * [1.0 / rings[0].inner_radius_mm]])
    return rings, [motion * scale for motion in motions]
