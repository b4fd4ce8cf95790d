"""Critical modes drawn on the body: the meridian's amplitudes revolved, added to the state at the crossing."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

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

# Largest displacement of the mode as drawn, of the body's radius: a mode has no size of its own.
DRAWN_SHARE = 0.4
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


def draw_mode(path: Path, model: ModesModel, refinement: int, folder: Path, crossing: FoundCrossing) -> str:
    """Draw a run's critical mode of a harmonic above the state it starts from; empty, or why there is no picture."""
    state, shape = read_shape(folder, crossing.waves)
    meridian = model.meridian(refinement)
    body = revolved(meridian, max(AROUND, 8 * crossing.waves))
    here = revolve_vector(state.displacement_mm, body)
    mode = revolved_mode(shape, body)
    size = DRAWN_SHARE * float(np.hypot(body.points[:, 0], body.points[:, 1]).max())
    pressure = revolve_scalar(pressure_at_corners(state, meridian.cells, meridian.cell.corners), body)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        stills: list[Still] = []
        for name, displacement in (
            ("straight", here),
            (f"m = {crossing.waves}", here + size / float(np.linalg.norm(mode, axis=1).max()) * mode),
        ):
            file = Path(place) / f"{len(stills)}.vtu"
            write_vtu(file, body, State(displacement, pressure, np.zeros((0, 0)), state.load_mpa))
            stills.append(Still(f"{crossing.pressure_kpa:.3g} kPa\n{name}", file))
        return draw_states(path, stills)
