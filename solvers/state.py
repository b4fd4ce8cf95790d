"""What passes between the solver and its callers: states in the caller's numbering, and seconds by activity."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # dolfinx takes a third of a second to import, which what only reads results need not pay
    from solvers.discrete.domain import FloatArray, IntArray


@dataclass(frozen=True)
class State:
    """An equilibrium (or a guess), in the caller's numbering of nodes and cells.

    Attributes
    ----------
    displacement_mm
        Shape (nodes, d).
    pressure_mpa
        Pressure field p. Continuous: at corner nodes, zero elsewhere, shape (nodes,). With jumps between cells: at
        the corners of each cell, shape (cells, corners).
    bodies_mm
        Motions of the rigid bodies, shape (bodies, modes): axial on a meridian and in a sector; x, y, z
        translation, then rotation about x, y, z times the arm, in full 3D.
    load_mpa
        Load factor P: the cavity pressure, or see solvers.energy.loads.
    """

    displacement_mm: FloatArray
    pressure_mpa: FloatArray
    bodies_mm: FloatArray
    load_mpa: float


def pressure_at_corners(state: State, cells: IntArray, corners: int) -> FloatArray:
    """Pressure at corner nodes, averaged over the cells there where it jumps; zero elsewhere, shape (nodes,), MPa."""
    if state.pressure_mpa.ndim == 1:
        return state.pressure_mpa
    at = cells[:, :corners].ravel()
    sums = np.bincount(at, weights=state.pressure_mpa.ravel(), minlength=len(state.displacement_mm))
    count = np.bincount(at, minlength=len(state.displacement_mm))
    return sums / np.maximum(count, 1)


def combine(states: Sequence[State], weights: Sequence[float]) -> State:
    """Weighted sum of states (rotations of bodies as vectors: for first guesses, not for results)."""
    pairs = list(zip(states, weights, strict=True))
    return State(
        np.asarray(sum(w * s.displacement_mm for s, w in pairs)),
        np.asarray(sum(w * s.pressure_mpa for s, w in pairs)),
        np.asarray(sum(w * s.bodies_mm for s, w in pairs)),
        float(sum(w * s.load_mpa for s, w in pairs)),
    )


@dataclass
class Timer:
    """Wall seconds by activity."""

    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Add the time spent in the block."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - start
