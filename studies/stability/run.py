"""Run a cell of the stress test: whatever happens becomes an outcome."""

from __future__ import annotations

import dataclasses
import math
import time

from mpi4py import MPI

from solvers.errors import StepFailed
from studies.stability.bodies import pose
from studies.stability.cells import Cell
from studies.stability.judge import Outcome, crash, judge
from studies.stability.paths import ends
from studies.stability.references import REFUSALS, Reference


def run_cell(cell: Cell, comm: MPI.Comm, reference: Reference | None = None, alone_mm: float = math.nan) -> Outcome:
    """Solve a cell and judge it; every rank of ``comm`` calls, and nothing is raised.

    Parameters
    ----------
    reference
        Of a bellows.
    alone_mm
        The value on one rank and one thread, for a cell of more.
    """
    begin = time.perf_counter()
    try:
        (end,) = ends(cell, pose(cell, comm), [abs(cell.load_kpa)])
        outcome = judge(cell, end, reference, alone_mm)
    except StepFailed as error:  # a path has to end in one, not to break
        outcome = crash(f"{error.cause}: {error}")
    except REFUSALS as error:
        outcome = Outcome("refusal", cause=type(error).__name__, reason=" ".join(str(error).split()))
    except Exception as error:  # a crash without a name is what this study is looking for
        outcome = crash(f"{type(error).__name__}: {error}")
    return dataclasses.replace(outcome, seconds=time.perf_counter() - begin)
