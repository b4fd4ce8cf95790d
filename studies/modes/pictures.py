"""Critical modes drawn on the body: the meridian's amplitudes revolved, added to the state at the crossing."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from meshes.gaps import outlines
from meshes.revolve import revolve_scalar, revolve_vector
from meshes.solid import FloatArray, SolidMesh
from solvers.stability.harmonics import Shape
from solvers.state import State, pressure_at_corners
from solvers.vtu import write_vtu
from studies.models.modes import FoundCrossing, read_shape
from studies.models.modes_model import ModesModel
from studies.report.pictures.child import draw_states
from studies.report.pictures.stills import Still
from studies.scene.meshes import revolved

# Largest displacement of the mode as drawn, of the body's radius: a mode has no size of its own. It is drawn smaller
# where surfaces would pass through each other, which is looked for in so many steps.
DRAWN_SHARE, _STEPS = 0.4, 100
# Of the size at which surfaces would touch: they are to be seen apart.
_CLEAR = 0.8
AROUND = 16


def revolved_mode(shape: Shape, body: SolidMesh) -> FloatArray:
    """Displacements of a mode on a revolved mesh, (nodes, 3) along (x, y, z), mm.

    Parameters
    ----------
    shape
        Amplitudes on the meridian: ``u = (a cos m t, c cos m t, b sin m t)`` along (r, z, t); at m = 0 b is a twist.
    body
        A mesh made by `meshes.revolve.revolve` or `meshes.sweep.revolve_hexahedra` from that meridian.
    """
    a, c, b = revolve_scalar(shape.amplitude_mm, body).T
    angle = body.angle_rad
    wave, quarter = np.cos(shape.waves * angle), np.sin(shape.waves * angle) if shape.waves else np.ones_like(angle)
    radial, along, round_ = a * wave, c * wave, b * quarter
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack([radial * cos - round_ * sin, radial * sin + round_ * cos, along])


def drawn_size(shape: Shape, meridian: SolidMesh, displacement_mm: FloatArray) -> float:
    """Largest displacement (mm) to draw a mode with: surfaces do not pass through each other.

    Looked for in the two half planes in which the mode has no part round the axis, where it is largest in them.
    """
    lines = [(meridian.points + displacement_mm)[outline.nodes] for outline in outlines(meridian)]
    in_plane, round_ = np.linalg.norm(shape.amplitude_mm[:, :2], axis=1), np.abs(shape.amplitude_mm[:, 2])
    mode = shape.amplitude_mm[:, :2] / float(np.maximum(in_plane, round_).max())
    modes = [mode[outline.nodes] for outline in outlines(meridian)]
    drawn = 0.0
    for size in DRAWN_SHARE * float(meridian.points[:, 0].max()) * np.arange(1, _STEPS + 1) / _STEPS:
        both = zip(lines, modes, strict=True)
        if any(crosses_itself(line + sign * size * move) for line, move in both for sign in (1.0, -1.0)):
            return _CLEAR * drawn
        drawn = float(size)
    return drawn


def crosses_itself(line: FloatArray) -> bool:
    """True if two pieces of a polyline, shape (n, 2), that are not neighbours cross."""
    begin, end = line[:-1], line[1:]
    # on which side of each piece (first index) every piece begins and ends
    first, last = (_cross((end - begin)[:, None], at[None] - begin[:, None]) for at in (begin, end))
    parted = first * last < 0.0
    return bool(np.triu(parted & parted.T, 2).any())


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def draw_mode(path: Path, model: ModesModel, refinement: int, folder: Path, crossing: FoundCrossing) -> str:
    """Draw a run's critical mode of a harmonic below the state it starts from; empty, or why there is no picture."""
    state, shape = read_shape(folder, crossing.waves)
    meridian = model.meridian(refinement)
    body = revolved(meridian, max(AROUND, 8 * crossing.waves))
    here = revolve_vector(state.displacement_mm, body)
    mode = revolved_mode(shape, body)
    size = drawn_size(shape, meridian, state.displacement_mm)
    pressure = revolve_scalar(pressure_at_corners(state, meridian.cells, meridian.cell.corners), body)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        stills: list[Still] = []
        for name, displacement in (
            ("straight", here),
            (
                f"m = {crossing.waves}, its largest displacement drawn as {size:.2g} mm",
                here + size / float(np.linalg.norm(mode, axis=1).max()) * mode,
            ),
        ):
            file = Path(place) / f"{len(stills)}.vtu"
            write_vtu(file, body, State(displacement, pressure, np.zeros((0, 0)), state.load_mpa))
            stills.append(Still(f"{crossing.pressure_kpa:.3g} kPa, {name}", file))
        return draw_states(path, stills)
