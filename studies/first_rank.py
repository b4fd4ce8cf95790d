"""Work that one rank does for all."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from mpi4py import MPI

Done = TypeVar("Done")


def first(comm: MPI.Comm, work: Callable[[], Done]) -> Done:
    """What rank 0 finds, on every rank; the others leave it their cores. An error is raised on every rank."""
    if comm.size == 1:
        return work()
    answer: tuple[Done | None, Exception | None] = (None, None)
    if comm.rank == 0:
        try:
            answer = (work(), None)
        except Exception as error:
            answer = (None, error)
    request = comm.Ibarrier()
    while not request.Test():
        time.sleep(0.05)
    done, fault = comm.bcast(answer)
    if fault is not None:
        raise fault
    found: Done = done
    return found
