"""Progress on the terminal; silent when the output is not one."""

from __future__ import annotations

import time

from mpi4py import MPI
from rich.console import Console
from rich.status import Status


class Progress:
    """Shows the running model, load, Newton iteration, elapsed and estimated time on rank 0 of a terminal.

    Parameters
    ----------
    comm
        Only its rank 0 shows anything.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        self._comm = comm
        self._console = Console(stderr=True)
        self._on = comm.rank == 0 and self._console.is_terminal
        self._status: Status | None = None
        self._case = self._label = ""
        self._start = 0.0
        self._highest_mpa = 0.0
        self._share = 0.0

    def case(self, place: int, count: int, name: str) -> None:
        """A study comes to one of its cases, counted from 1; what runs from now on belongs to it."""
        self._case = f"{name}, case {place} of {count}: "
        if self._on and self._status is None:
            self._console.print(self._case.removesuffix(": "), highlight=False)

    def begin(self, label: str, highest_mpa: float) -> None:
        """A run starts; it ends when the highest pressure is reached."""
        self._label, self._highest_mpa, self._share = self._case + label, highest_mpa, 0.0
        self._start = time.perf_counter()
        if self._on:
            self._status = self._console.status(f"{self._label}: meshing, compiling")
            self._status.start()

    def iteration(self, what: str, pressure_mpa: float, iteration: int, error: float) -> None:
        """A Newton iteration ended."""
        if self._status is None:
            return
        elapsed = time.perf_counter() - self._start
        share = min(max(pressure_mpa / self._highest_mpa, self._share), 1.0)
        left = f", about {elapsed / self._share - elapsed:.0f} s left" if self._share > 0.0 else ""
        self._status.update(
            f"{self._label}: {1e3 * pressure_mpa:.2f} kPa ({what}), Newton {iteration}, residual {error:.0e}, "
            f"{100.0 * share:.0f} %, {elapsed:.0f} s{left}"
        )

    def state(self, pressure_mpa: float) -> None:
        """A state converged."""
        self._share = max(self._share, min(pressure_mpa / self._highest_mpa, 1.0))

    def warn(self, line: str) -> None:
        """Something the user should know; said on rank 0 whether or not the output is a terminal."""
        if self._comm.rank == 0:
            self._console.print(line, highlight=False, soft_wrap=True)

    def end(self, line: str) -> None:
        """The run ended; ``line`` says how."""
        if self._status is not None:
            self._status.stop()
            self._status = None
        if self._on:
            self._console.print(line, highlight=False)
