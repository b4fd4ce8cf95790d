"""A boundary value problem on a domain: a solid, its load, and what is bonded to it or touches it.

Unknowns are the mixed finite-element dofs and, after them, the motions of rigid bodies bonded to the solid by an
elastic layer. The parts are in `solvers.assembly`.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from analytical.laws.stiff import StiffSolid
from solvers import compat
from solvers.assembly.checks import Deformation, refuse_overlaps
from solvers.assembly.load import Load
from solvers.assembly.supports import Supports
from solvers.assembly.surfaces import SOFT, STIFF, Surfaces, cell_measures
from solvers.assembly.tangent import assemble, new_matrix
from solvers.assembly.term import Term
from solvers.assembly.unknowns import Unknowns
from solvers.assembly.volumes import volume_measure
from solvers.bodies.bond import BondedBodies
from solvers.bodies.rigid import RigidBodies
from solvers.bodies.turning import Turning, turning_bodies
from solvers.compat.known_forms import KnownForms
from solvers.contact.contact import Contact
from solvers.discrete.domain import Domain, FloatArray
from solvers.discrete.elements import QUADRATURE_DEGREE, Element, usual_element
from solvers.discrete.kinematics import Kinematics, kinematics
from solvers.discrete.sums import Joint, dot
from solvers.energy.forms import Forms, build_forms
from solvers.energy.laws import Law, is_written_here
from solvers.energy.loads import DEAD
from solvers.energy.materials import Material, compile_parts, invariant_limits
from solvers.state import State, Timer


class Problem:
    """Assembled equations of one domain, material and set of rigid bodies.

    Parameters
    ----------
    domain
        Mesh; its cell tags are SOFT, STIFF or a number of ``others``.
    law
        Material of the soft cells.
    inverse_kappa
        1/kappa in 1/MPa; 0 is incompressible.
    surfaces
        Which facet numbers are loaded, clamped, bonded and on the axis.
    stiff
        Material of the STIFF cells, if any.
    bodies
        Rigid bodies, if any.
    element
        Displacement and pressure spaces; default the usual ones of the mesh's cells.
    quadrature_degree
        Default that of the mesh's cells.
    frame
        Directions of the displacement's components as columns, shape (3, 3), in 3D without bodies: with one along
        each of two oblique planes of symmetry the other component is what each of them holds. Default: x, y, z.
    others
        Further soft materials by the numbers of their cells. A pressure that is continuous is so within a material.

    Attributes
    ----------
    unknowns
        Numbering and current values; the usual ones are also here by their names.
    known_forms
        Its forms, and those that others write of its functions.
    load, deformation
        The load on the solid, and how far its cells are deformed.
    parts, invariant_limits
        The soft materials, compiled, and the limits of those laws that have one.
    contact
        A term that may be set once the problem is there.
    volume_start_mm3, volume_unit_mm3
        What volumes of the load are counted from and measured by: see `solvers.assembly.volumes`; the body's own volume
        for a load that keeps its direction.

    Raises
    ------
    SolverError
        If cells of the mesh fold over or overlap: they would count twice, and every answer would be wrong.
    """

    def __init__(
        self,
        domain: Domain,
        law: Law,
        inverse_kappa: float,
        surfaces: Surfaces,
        stiff: StiffSolid | None = None,
        bodies: RigidBodies | None = None,
        element: Element | None = None,
        quadrature_degree: int | None = None,
        frame: FloatArray | None = None,
        others: Mapping[int, Material] | None = None,
    ) -> None:
        assert frame is None or bodies is None
        compat.align_counters()
        self.domain, self.comm, self.timer = domain, domain.comm, Timer()
        self.surfaces, self.stiff, self.bodies, self.inverse_kappa = surfaces, stiff, bodies, float(inverse_kappa)
        self.element = element or usual_element(domain.cell_name)
        self.quadrature_degree = quadrature_degree or QUADRATURE_DEGREE[domain.cell_name]
        materials = {SOFT: Material(law, float(inverse_kappa)), **(others or {})}
        # forces are measured by the softest
        self.shear_modulus_mpa = min(float(m.law.initial_shear_modulus_mpa) for m in materials.values())
        self.contact: Contact | None = None
        self._number(materials, frame)
        has = (materials, self._jumping(materials), surfaces, stiff, bodies is not None, frame is not None)
        how = (domain.axisymmetric, self.element, self.quadrature_degree)
        tags = {"cell": domain.cell_tags, "exterior_facet": domain.facet_tags}
        decides = (has, how) if all(is_written_here(m.law) for m in materials.values()) else None
        self.known_forms = known = KnownForms(domain.mesh, tags, decides)
        known.part(self.space)
        known.part(self.state)
        self.pressure = known.constant(0.0)
        kin = kinematics(domain.mesh, domain.axisymmetric, None if frame is None else known.constant(frame))
        with self.timer("compile"):
            refuse_overlaps(domain, known)
        self._materials = materials
        numbers = [*materials, *([] if stiff is None else [STIFF])]
        self._measures = cell_measures(domain, self.quadrature_degree, numbers)
        self.parts = compile_parts(materials, known.constant, self._measures, self._jumping(materials))
        self.law, self.invariant_limits = self.parts[0].law, invariant_limits(self.parts)
        with self.timer("compile"):
            self._compile(kin)
        self._measure(kin)

    def _jumping(self, materials: Mapping[int, Material]) -> list[int]:
        """Numbers of the cells that need a pressure of their own: one that is continuous cannot jump between them."""
        return list(materials) if len(materials) > 1 and self.element.pressure == "continuous" else []

    def _number(self, materials: Mapping[int, Material], frame: FloatArray | None) -> None:
        """The unknowns, and short names for the usual ones."""
        held = np.zeros((0, 0), dtype=bool)
        if self.bodies is not None and self.surfaces.bond is not None:
            held = self.bodies.held_motions(self.domain.axisymmetric)
        fields: list[list[int] | None] = [[number] for number in self._jumping(materials)]
        fields = fields or [None if self.stiff is None else list(materials)]
        self.unknowns = of = Unknowns(self.domain, self.element, self.surfaces, fields, held, frame)
        self.space, self.state, self.index_map = of.space, of.state, of.index_map
        self.u_dofs, self.p_dofs, self.owned, self.extra = of.u_dofs, of.p_dofs, of.owned, of.extra
        self.owned_pressure, self.constrained_owned = of.owned_pressure, of.constrained_owned
        self.body_values, self.held_bodies = of.bodies_mm, of.held_bodies
        self.expected_negatives = of.expected_negatives

    def _compile(self, kin: Kinematics) -> None:
        """Forms of solid, load and bond."""
        degree, bodies, bond = self.quadrature_degree, self.bodies, self.surfaces.bond
        kind, loaded = self.surfaces.load
        # of a higher degree the load is a potential, as its form is, only if both are integrated exactly
        richer = self.element.displacement_degree > 2
        ds = self.domain.ds(degree=3 * self.element.displacement_degree - 1 if richer else degree)
        known = self.known_forms

        @functools.cache
        def solid() -> Forms:
            return build_forms(self.space, self.state, kin, self.parts, self.stiff, self._measures.get(STIFF))

        self.load = Load(kind, ds(loaded), self.unknowns, kin, self.pressure, self.timer, known)
        bonded: BondedBodies | None = None
        self.turning: Turning | None = None
        if bodies is not None and bond is not None:
            bonded = BondedBodies(self.unknowns, kin, bodies, ds(bond), self.load, known)
            self.turning = turning_bodies(self.unknowns, bodies, bonded.border.dofs)
        self.bonded = bonded

        def with_bond(name: str, of_solid: Any) -> Any:
            return of_solid if bonded is None else of_solid + getattr(bonded.forms, name)

        self._internal = known.compile("internal force", lambda: with_bond("internal_force", solid().internal_force))
        self._energy = known.compile("energy", lambda: with_bond("energy", solid().energy))
        self.load.compile(closed=bodies is not None and bodies.plate is not None and bodies.plate_closes)
        self.conservative = self.load.conservative
        self._tangent = known.compile(
            f"tangent, {'symmetric' if self.conservative else 'not symmetric'}",
            lambda: with_bond("tangent", self.load.tangent(solid().tangent)),
        )
        laws = {number: material.law for number, material in self._materials.items()}
        self.deformation = Deformation(self.unknowns, kin, degree, self.timer, self.parts, laws)

    def _measure(self, kin: Kinematics) -> None:
        """What residuals of the volume and volumes are measured by."""
        weight, dx = kin.measure, ufl.dx(domain=self.domain.mesh, degree=self.quadrature_degree)
        self.volume_measure = (weight, dx)

        def cells() -> Any:
            tests = ufl.TestFunctions(self.space)[1:]
            of_parts = [tests[part.field] * weight * part.measure for part in self.parts]
            return sum(of_parts[1:], of_parts[0]) if len(tests) > 1 else tests[0] * weight * dx

        with self.timer("compile"):
            form = self.known_forms.compile("cells", cells)
        unit = compat.assemble_array(form, self.index_map)
        self.volume_scale = float(np.sqrt(dot(self.comm, unit, unit)))
        body = float(self.comm.allreduce(float(unit.sum()), op=MPI.SUM))
        self.volume_start_mm3, self.volume_unit_mm3 = 0.0, body
        if self.load.kind not in DEAD:
            self.volume_start_mm3, self.volume_unit_mm3 = volume_measure(self.cavity_volume(), self.load.area())

    # ---- equations -------------------------------------------------------------------------------------

    @property
    def terms(self) -> tuple[Term, ...]:
        """What acts beside the solid and its load."""
        return tuple(term for term in (self.bonded, self.contact) if term is not None)

    @property
    def tangent_form(self) -> Any:
        """The compiled tangent of solid, load and bond, without what the terms add to it."""
        return self._tangent

    def new_matrix(self) -> PETSc.Mat:
        """Empty matrix with the pattern of the tangent."""
        return new_matrix(self.space, self.extra, self.conservative, [term.pattern() for term in self.terms])

    def assemble_tangent(self, matrix: PETSc.Mat) -> None:
        """Tangent at the current state, into ``matrix``."""
        self.assemble_held(matrix, self.unknowns.supports, [term.add_to for term in self.terms])

    def assemble_held(
        self, matrix: PETSc.Mat, supports: Supports, additions: Sequence[Callable[[PETSc.Mat], None]]
    ) -> None:
        """The solid's tangent at the current state under any supports, and what is added to it, into ``matrix``."""
        with self.timer("tangent"):
            assemble(matrix, self._tangent, supports.bcs, self.space, additions)

    def internal_force(self) -> tuple[FloatArray, FloatArray]:
        """Internal force on the owned dofs (owned,), residual of the bodies (extra,); constraints not yet applied.

        The bodies' residual includes the pressure and the dead force on a plate.
        """
        with self.timer("residual"):
            force, on_bodies = compat.assemble_array(self._internal, self.index_map), np.zeros(self.extra)
            for term in self.terms:
                term.add_force(force, on_bodies)
            return force, on_bodies

    def unit_load(self) -> Joint:
        """Force of a unit load on the free dofs and on the free bodies, mm^2, nothing on those that are held."""
        force = self.load.force()
        force[self.constrained_owned] = 0.0
        return force, self._on_plate()

    def volume_gradient(self) -> Joint:
        """Derivative of `cavity_volume` by the same: the force of a unit load if that is conservative."""
        gradient = self.load.gradient()
        gradient[self.constrained_owned] = 0.0
        return gradient, self._on_plate()

    def _on_plate(self) -> FloatArray:
        """What the cavity's volume gains with the bodies' motions, mm^2, shape (extra,)."""
        if self.bonded is None:
            return np.zeros(self.extra)
        return np.where(self.held_bodies, 0.0, self.load.sense * self.bonded.plate_volume()[1])

    def cavity_volume(self) -> float:
        """Volume on which the load does work, mm^3: enclosed for a cavity; see solvers.energy.loads for others."""
        by_plate = 0.0 if self.bonded is None else self.load.sense * self.bonded.plate_volume()[0]
        return self.load.volume() + by_plate

    def energy(self) -> float:
        """Stored energy of solid, bond and contact, mJ."""
        return compat.assemble_scalar(self._energy, self.comm) + sum(term.energy() for term in self.terms)

    @property
    def massless(self) -> NDArray[np.bool_]:
        """Owned dofs that are pressures or held, shape (owned,)."""
        return np.asarray(self.owned_pressure | self.constrained_owned)

    # ---- states ----------------------------------------------------------------------------------------

    def set_state(self, state: State) -> None:
        """Make a state in the caller's numbering the current one; constraints are imposed exactly."""
        self.unknowns.set(state)
        if self.bonded is not None:
            self.bonded.update(np.zeros(0))
        self.pressure.value = state.load_mpa

    def get_state(self) -> State:
        """The current state in the caller's numbering, complete on every rank."""
        return self.unknowns.get(float(self.pressure.value))

    def zero_state(self) -> State:
        """The unloaded reference state."""
        return self.unknowns.zero()
