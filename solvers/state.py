"""What passes between the solver and its callers: states in the caller's numbering, and seconds by activity."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from solvers.domain import FloatArray


@dataclass(frozen=True)
class State:
    """An equilibrium (or a guess), in the caller's node numbering.

    Attributes
    ----------
    displacement_mm
        Shape (nodes, d).
    pressure_mpa
        Pressure field p at corner nodes, zero elsewhere, shape (nodes,).
    bodies_mm
        Motions of the rigid bodies, shape (bodies, modes): axial in 2D; x, y, z translation, then rotation
        about x, y, z times the arm, in 3D.
    load_mpa
        Load factor P: the cavity pressure, or see solvers.loads.
    """

    displacement_mm: FloatArray
    pressure_mpa: FloatArray
    bodies_mm: FloatArray
    load_mpa: float


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
