"""The load on the solid: the volume on which it does work, and its force, as a potential and as a traction."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from solvers import compat
from solvers.assembly.unknowns import Unknowns
from solvers.compat.known_forms import KnownForms
from solvers.discrete.domain import FloatArray
from solvers.discrete.kinematics import Kinematics
from solvers.energy.loads import LoadForms, LoadKind, load_forms, load_tangent
from solvers.state import Timer

# Potential and traction form of a load are one load if their work on random directions differs by less than this.
SAME_LOAD = 1e-10


class Load:
    """The load of a problem: its factor, and forms of a unit of it, of use once they are compiled.

    Parameters
    ----------
    kind, measure
        See `solvers.energy.loads.load_forms`.
    unknowns, kin
        Of the problem.
    factor
        The load factor P.
    timer
        Takes the seconds of assembly.
    known
        Forms of the problem.

    Attributes
    ----------
    conservative
        True if the potential is the load.
    """

    def __init__(
        self,
        kind: LoadKind,
        measure: Any,
        unknowns: Unknowns,
        kin: Kinematics,
        factor: fem.Constant,
        timer: Timer,
        known: KnownForms,
    ) -> None:
        self.kind, self.factor = kind, factor
        self._unknowns, self._kin, self._measure = unknowns, kin, measure
        self._timer, self._known, self._one = timer, known, known.constant(1.0)

    @functools.cached_property
    def _forms(self) -> LoadForms:
        return load_forms(self.kind, self._unknowns.space, self._unknowns.state, self._kin, self._measure)

    def tangent(self, internal: Any) -> Any:
        """UFL tangent of internal force and load, after `compile`, which finds out if the load is conservative."""
        space, state = self._unknowns.space, self._unknowns.state
        return load_tangent(internal, self._forms, self.kind, self.conservative, space, state, self.factor)

    def compile(self, closed: bool) -> None:
        """Compile the forms and find out if the load is conservative; the unknowns are zero, and are so again then.

        Parameters
        ----------
        closed
            True if a plate closes the cavity and its rim moves: then the potential is the load, and the wall's traction
            only a part of it.
        """
        self._volume = self._known.compile("volume", lambda: self._forms.volume)
        self._gradient = self._known.compile("volume gradient", lambda: self._forms.volume_gradient)
        self._traction = self._known.compile("traction", lambda: self._forms.traction)
        self.conservative = closed or self._difference() <= SAME_LOAD

    def area(self) -> float:
        """Unloaded area of the loaded surface, mm^2."""
        with self._timer("compile"):
            form = self._known.compile("loaded area", lambda: self._one * self._kin.measure * self._measure)
        return compat.assemble_scalar(form, self._unknowns.comm)

    @property
    def sense(self) -> float:
        """1 if a unit load presses on a plate from inside, -1 if from outside."""
        return -1.0 if self.kind == "suction" else 1.0

    def inside_mpa(self) -> float:
        """Pressure on a plate from inside."""
        return self.sense * float(self.factor.value)

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
