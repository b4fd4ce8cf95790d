"""The errors of this package, and why a step or a path ends."""

from __future__ import annotations

from enum import StrEnum


class Cause(StrEnum):
    """Why a step failed or a path ended; the text beside it says where and with which numbers."""

    REACHED = "reached"
    LIMIT_POINT = "limit point"
    BIFURCATION = "bifurcation"
    INVERTED_CELL = "inverted cell"
    MATERIAL_RANGE = "out of the material's range"
    LAW_SOFTENS = "law no longer stable"
    LINEAR_SOLVER = "linear solver"
    OUT_OF_MEMORY = "out of memory"
    NO_RESPONSE = "volume does not respond"
    STEP_SIZE = "step size"
    TOO_LARGE = "too large"
    CONTACT = "contact"


class SolverError(RuntimeError):
    """A solve that cannot go on; the message says why and what to try."""


class StepFailed(SolverError):
    """One Newton solve failed; the path may retry with a smaller step. The last good state is untouched.

    Parameters
    ----------
    message
        What happened, with numbers.
    cause
        What kind of failure it is; STEP_SIZE stands for no convergence.
    """

    def __init__(self, message: str, cause: Cause = Cause.STEP_SIZE) -> None:
        super().__init__(message)
        self.cause = cause
