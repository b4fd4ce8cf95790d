"""The load on the solid: the volume on which it does work, and its force, as a potential and as a traction."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from solvers import compat
from solvers.assembly.unknowns import Unknowns
from solvers.discrete.domain import FloatArray
from solvers.energy.loads import LoadForms
from solvers.state import Timer

# Potential and traction form of a load are one load if their work on random directions differs by less than this.
SAME_LOAD = 1e-10


class Load:
    """Compiled forms of a unit load on a problem's unknowns.

    Parameters
    ----------
    forms
        See `solvers.energy.loads`.
    unknowns
        Their current values are those of the reference state; they are so again afterwards.
    closed
        True if a plate closes the cavity and its rim moves: then the potential is the load, and the wall's traction
        only a part of it.
    timer
        Takes the seconds of assembly.

    Attributes
    ----------
    conservative
        True if the potential is the load.
    """

    def __init__(self, forms: LoadForms, unknowns: Unknowns, closed: bool, timer: Timer) -> None:
        self._unknowns, self._timer = unknowns, timer
        self._volume = compat.compile_form(forms.volume)
        self._gradient = compat.compile_form(forms.volume_gradient)
        self._traction = compat.compile_form(forms.traction)
        self.conservative = closed or self._difference() <= SAME_LOAD

    def volume(self) -> float:
        """Volume on which the load does work, mm^3, without what a plate adds; see `solvers.energy.loads`."""
        return compat.assemble_scalar(self._volume, self._unknowns.comm)

    def gradient(self) -> FloatArray:
        """Derivative of `volume` on the owned dofs, mm^2, shape (owned,)."""
        with self._timer("residual"):
            return compat.assemble_array(self._gradient, self._unknowns.index_map)

    def traction(self) -> FloatArray:
        """Force of a unit load on the owned dofs without use of the potential, mm^2, shape (owned,)."""
        with self._timer("residual"):
            return compat.assemble_array(self._traction, self._unknowns.index_map)

    def force(self) -> FloatArray:
        """Force of a unit load on the owned dofs, mm^2: from the potential where that is the load."""
        return self.gradient() if self.conservative else self.traction()

    def _difference(self) -> float:
        """Largest difference of the load as potential and as traction, relative to the work that cancels in it.

        The Hessian of the potential is symmetric on any surface, so symmetry proves nothing: the two forces are
        compared on random directions that respect the constraints, at a random state that does too.
        """
        unknowns, comm = self._unknowns, self._unknowns.comm
        rng = np.random.default_rng([17, comm.rank])
        box = np.ptp(unknowns.domain.mesh.geometry.x, axis=0).max(initial=0.0)
        size = 0.01 * comm.allreduce(float(box), op=MPI.MAX)
        free = ~unknowns.constrained_owned
        unknowns.state.x.array[: unknowns.owned] = size * rng.standard_normal(unknowns.owned) * free
        unknowns.state.x.scatter_forward()
        potential, traction = self.gradient(), self.traction()
        unknowns.state.x.array[:] = 0.0
        directions = rng.standard_normal((5, unknowns.owned)) * free
        different = comm.allreduce(directions @ (potential - traction), op=MPI.SUM)
        whole = comm.allreduce(np.abs(directions) @ np.abs(traction), op=MPI.SUM)
        return float((np.abs(different) / np.maximum(whole, np.finfo(float).tiny)).max())
