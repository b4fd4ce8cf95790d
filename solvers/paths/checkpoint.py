"""Checkpoints: what a path needs to go on, in one file, in the caller's numbering and so for any number of ranks.

A file is a zip archive of arrays, whose parts carry checksums; it is written beside the old one and then renamed. A
file that is damaged, or was written for another content, is refused with the reason.
"""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from solvers.atomic import write_atomically
from solvers.errors import Cause, SolverError
from solvers.paths.states import Crossing, GuessMemory, PathMemory, PathPoint
from solvers.state import State

_NUMBERS = [f.name for f in fields(Crossing) if f.name not in ("state", "mode")]


class CheckpointError(SolverError):
    """A checkpoint that cannot be used; the message names the file and says why."""


def write_checkpoint(path: Path, label: str, memory: PathMemory | GuessMemory, notes: Any) -> None:
    """Write a checkpoint atomically. One rank calls.

    Parameters
    ----------
    path
        The file.
    label
        What the path belongs to, for instance a hash of its inputs.
    memory
        What a path following handed to ``on_step``.
    notes
        Anything that can be written as JSON, handed back by `read_checkpoint`.
    """
    if isinstance(memory, PathMemory):
        points, states = memory.history, [p.state for p in memory.history]
        facts: dict[str, Any] = {
            "kind": "path",
            "points": [_facts(p) for p in points],
            "control": memory.control,
            "step": memory.step,
            "stiffest_mpa_per_mm3": memory.stiffest_mpa_per_mm3,
            "limit_mpa": memory.limit_mpa,
        }
    else:
        points, states = (memory.last,), [memory.last.state, memory.guess]
        facts = {"kind": "guesses", "points": [_facts(memory.last)], "share": memory.share}
    crossing = memory.crossing
    facts |= {
        "label": label,
        "reached": memory.reached,
        "rejected": memory.rejected,
        "crossing": None if crossing is None else {name: getattr(crossing, name) for name in _NUMBERS},
        "notes": notes,
    }
    parts = {str(k): state for k, state in enumerate(states)}
    parts |= {f"{k}.rate": point.rate for k, point in enumerate(points) if point.rate is not None}
    arrays = {f"{part}.{name}": value for part, state in parts.items() for name, value in asdict(state).items()}
    buffer = io.BytesIO()
    np.savez(buffer, facts=json.dumps(facts), **arrays)
    write_atomically(path, buffer.getvalue())


def read_checkpoint(path: Path, label: str) -> tuple[PathMemory | GuessMemory, Any] | None:
    """The memory and the notes of a checkpoint, None if there is no file.

    Raises
    ------
    CheckpointError
        If the file is truncated or damaged, is none of these, or belongs to another label.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            facts = json.loads(str(data["facts"]))
            parts = [name.removesuffix(".load_mpa") for name in data.files if name.endswith(".load_mpa")]
            read = {part: State(**{f.name: data[f"{part}.{f.name}"][()] for f in fields(State)}) for part in parts}
        if facts["label"] != label:
            raise CheckpointError(f"{path}: belongs to another scene, mesh or version of the code, not used")
        return _memory(facts, read), facts["notes"]
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"{path}: damaged, not used ({type(error).__name__}: {error})") from error


def _memory(facts: dict[str, Any], read: dict[str, State]) -> PathMemory | GuessMemory:
    """The memory of a file's facts and states by name; a KeyError, ValueError or TypeError if they are no such."""
    crossing = facts["crossing"]
    if crossing is not None:
        crossing = Crossing(**{**crossing, "kind": Cause(crossing["kind"])})
    points = [PathPoint(read[str(k)], **of, rate=read.get(f"{k}.rate")) for k, of in enumerate(facts["points"])]
    if facts["kind"] == "path":
        return PathMemory(
            tuple(points),
            facts["control"],
            facts["step"],
            facts["reached"],
            facts["rejected"],
            facts["stiffest_mpa_per_mm3"],
            crossing,
            facts["limit_mpa"],
        )
    return GuessMemory(points[0], read["1"], facts["reached"], facts["share"], facts["rejected"], crossing)


def _facts(point: PathPoint) -> dict[str, Any]:
    return {f.name: getattr(point, f.name) for f in fields(PathPoint) if f.name not in ("state", "rate")}
