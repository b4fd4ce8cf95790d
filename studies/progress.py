"""Progress on the terminal; plain lines, not too many, where the output is a log."""

from __future__ import annotations

import time

from mpi4py import MPI
from rich.console import Console
from rich.status import Status

from studies.report.numbers import duration

# Least time between two lines of a log, s.
LOG_EVERY_S = 20.0
# Share of a study's cases that say something of how long the others take: the first are often the largest.
TELLING = 0.2


class Progress:
    """Shows the running model, load, Newton iteration, elapsed and estimated time on rank 0 of a terminal.

    Of a study it tells the cases and, from those that are done, how long the rest may take; in a log too.

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
        self._study = self._last = time.perf_counter()
        self._cases = 0.0
        self._start = 0.0
        self._highest_mpa = 0.0
        self._share = 0.0

    def case(self, place: int, count: int, name: str) -> None:
        """A study comes to one of its cases, counted from 1; what runs from now on belongs to it."""
        self._case = f"{name}, case {place} of {count}: "
        now = time.perf_counter()
        self._cases = self._cases or now
        if self._comm.rank or (not self._on and now - self._last < LOG_EVERY_S) or self._status is not None:
            return
        self._last, so_far = now, now - self._study
        line = f"case {place} of {count}, {name}"
        if place > 1:
            line += f"; {duration(so_far)} so far"
        if place - 1 >= TELLING * count:
            line += f", about {duration((now - self._cases) / (place - 1) * (count - place + 1))} left"
        self._console.print(line, highlight=False, soft_wrap=True)

    def tell(self, line: str) -> None:
        """Say what a study does before its cases."""
        if self._comm.rank == 0 and self._status is None:
            self._console.print(line, highlight=False, soft_wrap=True)

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
