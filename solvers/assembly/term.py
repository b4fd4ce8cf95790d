"""What acts beside the solid and its load: the bond to rigid bodies, contact."""

from __future__ import annotations

from typing import Any, Protocol

import scipy.sparse

from solvers.discrete.domain import FloatArray


class Term(Protocol):
    """A part of the potential that is not, or not wholly, an integral over the solid's own form.

    Its unknowns are the owned dofs and, after them, those of the bodies.
    """

    def energy(self) -> float:
        """Energy beyond the integrals of the solid's form, mJ."""
        ...

    def add_force(self, on_dofs: FloatArray, on_bodies: FloatArray) -> None:
        """Add its force on the owned dofs (owned,) and on the bodies (extra,), N, in place."""
        ...

    def pattern(self) -> scipy.sparse.csr_matrix:
        """Places that it needs in this rank's rows of the tangent; every rank calls."""
        ...

    def grow(self) -> bool:
        """Take the current state's places into `pattern`; True if there are new ones."""
        ...

    def add_to(self, matrix: Any) -> None:
        """Add its second derivative to the tangent, which is in flush state and has the places of `pattern`."""
        ...

    def check(self) -> None:
        """Refuse a converged state that it does not hold for.

        Raises
        ------
        StepFailed
            With the reason.
        """
        ...
