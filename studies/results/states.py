"""States on disk: one file each, written whole or not at all, known by the content they belong to; and their fields."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from solvers.files import write_atomically
from solvers.state import State
from studies.results.files import FIELDS_FOLDER, PathRow, write_text_atomically

STATES_FOLDER = "states"


def _state_file(folder: Path, pressure_mpa: float) -> Path:
    return folder / STATES_FOLDER / f"p{1e3 * abs(pressure_mpa):09.4f}.npz"


def save_state(folder: Path, content_hash: str, state: State, row: PathRow) -> None:
    """Write a state and its row of figures atomically."""
    buffer = io.BytesIO()
    np.savez(buffer, **asdict(state), row=json.dumps(asdict(row)), content_hash=content_hash)
    write_atomically(_state_file(folder, state.load_mpa), buffer.getvalue())


def load_state(folder: Path, content_hash: str, pressure_mpa: float) -> tuple[State, PathRow] | None:
    """A saved state, or None if it is missing, damaged or of another content."""
    try:
        with np.load(_state_file(folder, pressure_mpa), allow_pickle=False) as data:
            if str(data["content_hash"]) != content_hash:
                return None
            state = State(data["displacement_mm"], data["pressure_mpa"], data["bodies_mm"], float(data["load_mpa"]))
            return state, PathRow(**json.loads(str(data["row"])))
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        return None


def field_file(folder: Path, pressure_mpa: float) -> Path:
    """Where a run's fields at a load are."""
    return folder / FIELDS_FOLDER / f"p{1e3 * abs(pressure_mpa):06.3f}.vtu"


def field_files(folder: Path, pressures_kpa: Sequence[float]) -> dict[float, Path]:
    """The field files a run has written, by pressure in kPa."""
    files = {p: field_file(folder, 1e-3 * p) for p in pressures_kpa}
    return {p: f for p, f in files.items() if f.exists()}


def write_collection(folder: Path, pressures_kpa: Sequence[float]) -> None:
    """A ParaView collection over the pressures."""
    entries = "".join(
        f'<DataSet timestep="{p:g}" file="{f.relative_to(folder)}"/>'
        for p, f in field_files(folder, pressures_kpa).items()
    )
    text = f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>'
    write_text_atomically(folder / "fields.pvd", text)
