"""States on disk: one file each, written whole or not at all, known by the content they belong to."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from solvers.state import State
from studies.results.files import PathRow, write_atomically

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
