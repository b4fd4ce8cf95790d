"""The errors of this package."""


class SolverError(RuntimeError):
    """A solve that cannot go on; the message says why and what to try."""


class StepFailed(SolverError):
    """One Newton solve failed; the path may retry with a smaller step. The last good state is untouched."""
