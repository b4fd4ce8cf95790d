"""Stability of an axisymmetric state against perturbations that are not: one tangent per harmonic of the angle.

The operator lives on the meridian mesh of a `solvers.problem.Problem` and reads its state. What is held in three
dimensions is held here:

==============================  ==================================================================================
held                            amplitudes (a, c, b) along (r, z, theta)
==============================  ==================================================================================
clamped                         all zero
axially, also by a blocked tip  c = 0
radially, off the axis          a = b = 0: what holds a wall radially holds it as a bond does
the axis                        what a smooth field does there, see `solvers.stability.harmonic_forms`
==============================  ==================================================================================

Motions that nothing holds and that cost nothing (drift of a body that is only held axially, its spin) would make the
tangent singular; one displacement is then pinned, which takes away nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from solvers import compat
from solvers.assembly.supports import dofs_of_facets, idle_pressures
from solvers.assembly.surfaces import SOFT, STIFF, cell_measures
from solvers.assembly.tangent import Border, assemble, bonded_dofs, new_matrix
from solvers.assembly.term import Term
from solvers.assembly.unknowns import displacement_dofs
from solvers.discrete.domain import FloatArray, IntArray
from solvers.discrete.kinematics import kinematics
from solvers.energy.loads import DEAD
from solvers.errors import SolverError
from solvers.problem import Problem
from solvers.stability.harmonic_bodies import MOTIONS, HarmonicBond
from solvers.stability.harmonic_forms import harmonic_load, harmonic_tangent, new_wave
from solvers.state import Timer

# Nodes closer to the axis than this part of the mesh's radius are on it.
ON_AXIS = 1e-9


@dataclass(frozen=True)
class Shape:
    """Amplitudes of a perturbation in the caller's numbering.

    Attributes
    ----------
    waves
        Its harmonic m.
    amplitude_mm
        Along (r, z, theta), to be multiplied by (cos m t, cos m t, sin m t), shape (nodes, 3); at m = 0 the last is
        a twist.
    bodies_mm
        Translation and rotation times the arm of the rigid bodies, shape (bodies, 2).
    """

    waves: int
    amplitude_mm: FloatArray
    bodies_mm: FloatArray


class Harmonics:
    """Tangents of the harmonics about the current state of an axisymmetric problem; `select` says of which.

    It can be given to `solvers.linear.factor.Factor`, which then counts the unstable modes of the harmonic.

    Parameters
    ----------
    problem
        A problem on a meridian, on one rank.

    Raises
    ------
    SolverError
        If the problem is not axisymmetric, on several ranks, of linear displacements, or its load not conservative.
    """

    conservative = True
    terms: tuple[Term, ...] = ()

    def __init__(self, problem: Problem) -> None:
        if not problem.domain.axisymmetric or problem.comm.size != 1:
            raise SolverError(
                "harmonics need a meridian on one rank, got dimension "
                f"{problem.unknowns.dimension} on {problem.comm.size} ranks"
            )
        if problem.element.displacement_degree != 2:
            raise SolverError(f"harmonics need quadratic displacements, got {problem.element.name}")
        if len(problem.parts) > 1:
            raise SolverError(f"harmonics know one soft material, not {len(problem.parts)}")
        if not problem.conservative:
            raise SolverError("harmonics need a conservative load: the tangent of this one has no inertia to count")
        self.problem, self.domain, self.comm = problem, problem.domain, problem.comm
        self.timer = Timer()
        self.waves = 0
        mesh = self.domain.mesh
        cell = mesh.ufl_cell()
        displacement = compat.element("Lagrange", cell, problem.element.displacement_degree, (3,))
        pressure = compat.sub_elements(problem.element.spaces(cell))[1]
        self.space = compat.function_space(mesh, compat.mixed_element([displacement, pressure]))
        self.index_map = self.space.dofmap.index_map
        self.owned = self.index_map.size_local
        self.bodies = 0 if problem.bonded is None else problem.bonded.count
        self.extra = MOTIONS * self.bodies
        self.bond: HarmonicBond | None = None
        self._known = problem.known_forms.more("harmonics")
        self._known.part(self.space)
        self._wave = new_wave(self._known.constant)
        self._number_unknowns()
        self._find_supports()
        self._border = Border(self.space, bonded_dofs(self.domain, self.space, 3, self.bodies), MOTIONS)
        with self.timer("compile"):
            self._compile()
        self.select(0)

    def _compile(self) -> None:
        """The tangent's form, and those of the bodies."""
        problem, mesh, degree = self.problem, self.domain.mesh, self.problem.quadrature_degree
        kin = kinematics(mesh, True)
        ds = self.domain.ds(degree=degree)
        measures = cell_measures(self.domain, degree, (SOFT,) if problem.stiff is None else (SOFT, STIFF))
        inverse_kappa = self._known.constant(problem.inverse_kappa)
        wave, (kind, loaded) = self._wave, problem.surfaces.load
        if problem.bonded is not None and problem.bodies is not None:
            self.bond = HarmonicBond(problem.bonded, problem.bodies, self.space, kin, wave, self._known)

        def tangent() -> Any:
            form = harmonic_tangent(
                self.space, problem.state, kin, problem.law, inverse_kappa, problem.stiff, measures, wave
            )
            if kind not in DEAD:
                by_load = problem.pressure * harmonic_load(self.space, problem.state, kin, ds(loaded), wave)
                form = form + by_load if kind == "suction" else form - by_load
            return form if self.bond is None else form + self.bond.stiffness

        self._tangent = self._known.compile("tangent", tangent)

    # ---- unknowns and what is held -------------------------------------------------------------------------

    def _number_unknowns(self) -> None:
        """Dofs of (a, c, s) at the mesh's nodes (nodes, 3), and those of q."""
        self.u_dofs = displacement_dofs(self.domain, self.space, 3)
        on_cells = compat.cell_dofs(self.space.sub(1))
        self.p_dofs = np.unique(on_cells).astype(np.int64)
        self._stiff_pressure = np.zeros(0, dtype=np.int64)
        if self.problem.stiff is not None:
            self._stiff_pressure = idle_pressures(self.domain, self.space, 1, (SOFT,))
        self._axis_pressure = np.zeros(0, dtype=np.int64)
        if self.problem.element.pressure == "continuous":
            corners = compat.geometry_dofs(self.domain.mesh)[:, : self.domain.corners]
            self._axis_pressure = np.unique(on_cells[self._on_axis[corners]]).astype(np.int64)

    @property
    def _on_axis(self) -> Any:
        """True for each of the mesh's nodes that is on the axis."""
        r = self.domain.mesh.geometry.x[:, 0]
        return np.abs(r) <= ON_AXIS * np.abs(r).max()

    def _find_supports(self) -> None:
        """Held dofs of (a, c, s) off the axis, the same in every harmonic."""
        surfaces, tags = self.problem.surfaces, self.domain.facet_tags
        if surfaces.pinned:
            raise SolverError("harmonics of a meridian with pinned nodes: hold a surface instead")
        held = [] if surfaces.clamped is None else [(surfaces.clamped, i) for i in range(3)]
        if surfaces.blocked is not None:
            held.append((surfaces.blocked, 1))
        for number, component in surfaces.held:
            held += [(number, 1)] if component == 1 else [(number, 0), (number, 2)]
        axis = self.u_dofs[self._on_axis].ravel()
        self._held: list[IntArray] = []
        for i in range(3):
            facets = tags.indices[np.isin(tags.values, [number for number, j in held if j == i])]
            dofs = dofs_of_facets(self.domain, self.space, facets, i)
            # the axis is named as held radially
            self._held.append(dofs if i == 1 else np.setdiff1d(dofs, axis))

    def select(self, waves: int) -> None:
        """Go over to a harmonic m >= 0: the next tangent is K_m."""
        self.waves = waves
        self._wave.set(waves)
        on_axis = self.u_dofs[self._on_axis].T
        smooth = {0: (0, 2), 1: (1, 2)}.get(waves, (0, 1, 2))
        fixed = [np.union1d(d, on_axis[i]) if i in smooth else d for i, d in enumerate(self._held)]
        none = np.zeros((0, MOTIONS), dtype=bool)
        held = none if self.bond is None else self.bond.held(waves)
        pin = self._pin(held)
        if pin is not None:
            fixed[pin[0]] = np.append(fixed[pin[0]], pin[1])
        pressures = np.union1d(self._stiff_pressure, self._axis_pressure if waves else [])
        spaces = [*(self.space.sub(0).sub(i) for i in range(3)), self.space.sub(1)]
        self.bcs = [compat.hold(np.sort(dofs), space) for dofs, space in zip([*fixed, pressures], spaces, strict=True)]
        self.is_constrained = np.zeros(self.owned, dtype=bool)
        for dofs in (*fixed, pressures):
            self.is_constrained[np.asarray(dofs, dtype=np.int64)] = True
        self.held_motions = held
        self.expected_negatives = len(self.p_dofs) - len(pressures)

    def _pin(self, held: Any) -> tuple[int, int] | None:
        """Component and dof to pin against a motion that costs nothing: drift (m = 1) or spin (m = 0).

        A body that can tilt freely, or slide along the axis, has no axisymmetric path either.
        """
        holds = len(self._held[0]) + len(self._held[2])
        free = holds == 0 and not held[:, 0 if self.waves == 1 else 1].any()
        if not free or self.waves > 1:
            return None
        component = 0 if self.waves == 1 else 2
        dofs = self.u_dofs[np.argmax(self.domain.mesh.geometry.x[:, 0])]
        return component, int(dofs[component])

    @property
    def massless(self) -> NDArray[np.bool_]:
        """Owned dofs that are pressures or held, shape (owned,)."""
        out = self.is_constrained.copy()
        out[self.p_dofs] = True
        return out

    # ---- the matrix, as `solvers.linear.factor.Factor` wants it ----------------------------------------------------

    def new_matrix(self) -> PETSc.Mat:
        """Empty matrix with the pattern of every harmonic and the bodies' border."""
        patterns = [] if self.bond is None else [self._border.pattern()]
        return new_matrix(self.space, self.extra, True, patterns)

    def assemble_tangent(self, matrix: PETSc.Mat) -> None:
        """K_m at the problem's current state, into ``matrix``."""
        with self.timer("tangent"):
            additions = [] if self.bond is None else [self._add_border]
            assemble(matrix, self._tangent, self.bcs, self.space, additions)

    def _add_border(self, matrix: PETSc.Mat) -> None:
        """Add the bodies' rows, columns and blocks."""
        assert self.bond is not None
        columns, blocks = self.bond.border(self.waves)
        columns[self.is_constrained] = 0.0
        self._border.add(matrix, columns, blocks, self.held_motions)

    # ---- shapes ----------------------------------------------------------------------------------------------

    def shape_of(self, dofs: FloatArray, bodies: FloatArray) -> Shape:
        """Amplitudes in the caller's numbering of unknowns (owned,) and (extra,) of the current harmonic."""
        out = np.zeros((self.domain.nodes, 3))
        out[self.domain.input_node] = self._wave.values(dofs[self.u_dofs])
        return Shape(self.waves, out, bodies.reshape(self.bodies, MOTIONS))
