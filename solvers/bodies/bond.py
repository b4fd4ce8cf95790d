"""Rigid bodies bonded to the solid by an elastic layer, with finite rotations.

A body k has a translation U and a rotation R = exp(w) about its centre c. A surface point X of the solid bonded to it
slips, in the body's frame, by

    e = R' (X - c + u - U) - (X - c),        energy 1/2 int g (kn (e.n)^2 + kt |e - (e.n) n|^2) dA

with n the reference normal, stiffnesses kn, kt per area and a grade g >= 0 (1 in the middle of a seat). With a rotation
increment R -> R exp(W_j), variations for body unknown j (translation d_j, skew W_j) and test function v are

    e_v = R' v,   e_j = -W_j y - R' d_j,   e_vj = -W_j R' v,   e_ij = sym(W_i W_j) y + W_j R' d_i + W_i R' d_j

where y = e + X - c. The second variations matter: with linearised rotations the tractions of a pressurised wall on
the ring make torsion and tilting look unstable. On a meridian, and in a sector between planes of symmetry, a body
only moves axially; half a body between them has three motions. Couplings and blocks can be had in other motions than
the state's: those of perturbations that do not share its symmetry (`solvers.stability.parity`).
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from solvers import compat
from solvers.assembly.load import Load
from solvers.assembly.tangent import Border, bonded_dofs
from solvers.assembly.unknowns import Unknowns
from solvers.bodies.plate import enclosed_by_plate
from solvers.bodies.rigid import AXIAL, RigidBodies, as_six, moved
from solvers.compat.known_forms import KnownForms
from solvers.discrete.domain import Domain, FloatArray, IntArray
from solvers.discrete.kinematics import Kinematics
from solvers.energy.forms import Forms


class BondedBodies:
    """The bonded bodies of a problem and their bond: a `solvers.assembly.term.Term`, with forms that join the solid's.

    Parameters
    ----------
    unknowns
        Of the problem.
    kin
        Kinematics of the mesh.
    bodies
        The bodies and their bond.
    measure
        Facet measure of the bonded surfaces, quadrature degree included.
    load
        Of the problem: it acts on a plate too.
    known
        Forms of the problem.

    Attributes
    ----------
    values, is_held
        Unknowns of the bodies, shape (bodies, motions), and which are held, shape (size,).
    motions
        Which of the six motions these are.
    dead_force_n
        Dead axial force on a plate that is not held.
    """

    def __init__(
        self,
        unknowns: Unknowns,
        kin: Kinematics,
        bodies: RigidBodies,
        measure: Any,
        load: Load,
        known: KnownForms,
    ) -> None:
        domain, space = unknowns.domain, unknowns.space
        mesh = domain.mesh
        self.comm, self.centres_mm, self.arm_mm = domain.comm, bodies.centres_mm, bodies.arm_mm
        self._plate, self._plate_area = bodies.plate, bodies.plate_area_mm2
        self.load = load
        self.values, self.is_held = unknowns.bodies_mm, unknowns.held_bodies
        self.count, self.motions = len(self.values), bodies.motions_on(domain.axisymmetric)
        self.dead_force_n = 0.0 if bodies.plate is None or bodies.plate_held else bodies.plate_force_n
        self.cells = _cells_of_bodies(domain, self.count)
        dofs = bonded_dofs(domain, space, unknowns.dimension, self.count)
        # cells between two bodies have dofs of both, their bonded facets never
        self.border = Border(space, [d[~unknowns.constrained_owned[d]] for d in dofs], len(self.motions))
        self._index_map = unknowns.index_map
        self._space, self._state, self._kin, self.measure = space, unknowns.state, kin, measure
        self.grade = known.part(_nodal_function(domain, bodies.grade))
        self._normal, self._tangential = (
            known.constant(stiffness) for stiffness in (bodies.normal_mpa_per_mm, bodies.tangential_mpa_per_mm)
        )
        vectors, turns = (compat.function_space(mesh, ("DG", 0), shape) for shape in ((3,), (3, 3)))
        self._translation, self._rotation = known.function(vectors), known.function(turns)
        self._centre = known.function(vectors)
        self._axial = 1 if domain.axisymmetric else 2
        for body, cells in enumerate(self.cells):
            self._centre.x.array.reshape(-1, 3)[cells, self._axial] = bodies.centres_mm[body]
        self._shifts = [known.constant(np.zeros(3)) for _ in range(2)]
        self._spins = [known.constant(np.zeros(3)) for _ in range(2)]
        self._per_cell = known.part(compat.function_space(mesh, ("DG", 0)))
        self._cell_map = self._per_cell.dofmap.index_map
        self._column_form = known.compile("bond column", lambda: self._by_bodies["column"])
        self._block_form = known.compile("bond block", lambda: self._by_bodies["block"])
        self._force_form = known.compile("bond force", lambda: self._by_bodies["force"])
        weight = self.grade * kin.measure
        self._slip_form = known.compile("bond slip", lambda: ufl.inner(self.slip, self.slip) * weight * measure)
        self._area_form = known.compile("bond area", lambda: weight * measure)
        self.update(np.zeros(0))

    # ---- forms, in UFL; what the harmonics of an axisymmetric state need of them has no underscore -------------

    @functools.cached_property
    def arm(self) -> Any:
        """``X - c``."""
        return self._kin.three(self._kin.position) - self._centre

    @functools.cached_property
    def _slipped(self) -> Any:
        """``y = e + X - c``."""
        u = self._kin.three(ufl.split(self._state)[0])
        return self._rotation.T * (self.arm + u - self._translation)

    @functools.cached_property
    def slip(self) -> Any:
        """``e``."""
        return self._slipped - self.arm

    def traction(self, slip: Any) -> Any:
        """Traction of the layer at a slip, MPa, without the grade."""
        n = self._kin.normal
        along = ufl.inner(slip, n) * n
        return self._normal * along + self._tangential * (slip - along)

    @functools.cached_property
    def forms(self) -> Forms:
        """Of the bond's energy and its derivatives by the dofs."""
        at, back = self.grade * self._kin.measure, self._rotation.T
        v, du = (self._kin.three(ufl.split(of(self._space))[0]) for of in (ufl.TestFunction, ufl.TrialFunction))
        pull = self.traction(self.slip)
        return Forms(
            internal_force=ufl.inner(pull, back * v) * at * self.measure,
            tangent=ufl.inner(self.traction(back * du), back * v) * at * self.measure,
            energy=0.5 * ufl.inner(pull, self.slip) * at * self.measure,
        )

    @functools.cached_property
    def _by_bodies(self) -> dict[str, Any]:
        """Derivatives by motions of the bodies, directions 0 and 1: column with the dofs, block and force by cell."""
        back, y, pull = self._rotation.T, self._slipped, self.traction(self.slip)
        v, pick = self._kin.three(ufl.split(ufl.TestFunction(self._space))[0]), ufl.TestFunction(self._per_cell)
        s0, s1 = self._spins
        d0, d1 = (back * shift for shift in self._shifts)

        def first(k: int) -> Any:
            return -ufl.cross(self._spins[k], y) - back * self._shifts[k]

        second = (
            0.5 * (ufl.cross(s0, ufl.cross(s1, y)) + ufl.cross(s1, ufl.cross(s0, y)))
            + ufl.cross(s1, d0)
            + ufl.cross(s0, d1)
        )
        pulled = self.traction(first(0))
        at, ds = self.grade * self._kin.measure, self.measure
        return {
            "column": (ufl.inner(pulled, back * v) - ufl.inner(pull, ufl.cross(s0, back * v))) * at * ds,
            "block": (ufl.inner(pulled, first(1)) + ufl.inner(pull, second)) * pick * at * ds,
            "force": ufl.inner(pull, first(0)) * pick * at * ds,
        }

    @property
    def size(self) -> int:
        """Number of body unknowns."""
        return self.values.size

    def _aim(self, k: int, motion: int) -> None:
        """Set direction k to a motion."""
        self._shifts[k].value[:] = 0.0
        self._spins[k].value[:] = 0.0
        if motion == AXIAL[0]:
            self._shifts[k].value[self._axial] = 1.0
        elif motion < 3:
            self._shifts[k].value[motion] = 1.0
        else:
            self._spins[k].value[motion - 3] = 1.0 / self.arm_mm

    def update(self, step: FloatArray) -> None:
        """Move the bodies by an increment of their unknowns, shape (size,) (empty: refresh the fields only)."""
        if len(step):
            change = step.reshape(self.values.shape)
            self.values[:] = moved(self.values, change, self.arm_mm, self.motions)
        six = as_six(self.values, self.motions)
        for body, cells in enumerate(self.cells):
            shift = six[body, :3].copy()
            turn = np.eye(3)
            if self.motions == AXIAL:
                shift[[AXIAL[0], self._axial]] = shift[[self._axial, AXIAL[0]]]
            else:
                turn = Rotation.from_rotvec(six[body, 3:] / self.arm_mm).as_matrix()
            self._translation.x.array.reshape(-1, 3)[cells] = shift
            self._rotation.x.array.reshape(-1, 9)[cells] = turn.ravel()

    def turns(self) -> FloatArray:
        """Rotations of the bodies, shape (bodies, 3, 3)."""
        return np.asarray(Rotation.from_rotvec(as_six(self.values, self.motions)[:, 3:] / self.arm_mm).as_matrix())

    def _per_body(self, form: Any) -> FloatArray:
        values = compat.assemble_array(form, self._cell_map)
        return self.comm.allreduce(np.array([values[c].sum() for c in self.cells]), op=MPI.SUM)

    def forces(self) -> FloatArray:
        """Derivative of the bond energy with respect to the body unknowns, shape (size,)."""
        out = np.empty((self.count, len(self.motions)))
        for i, motion in enumerate(self.motions):
            self._aim(0, motion)
            out[:, i] = self._per_body(self._force_form)
        return out.ravel()

    def columns(self, motions: Sequence[int]) -> FloatArray:
        """Coupling of dofs and motions, all bodies added up, on the owned dofs, shape (owned, motions)."""
        out = np.empty((self._index_map.size_local, len(motions)))
        for i, motion in enumerate(motions):
            self._aim(0, motion)
            out[:, i] = compat.assemble_array(self._column_form, self._index_map)
        return out

    def blocks(self, motions: Sequence[int]) -> FloatArray:
        """Second derivative of the energy, the pressure's on a plate included, in motions of each body.

        Shape (bodies, motions, motions).
        """
        out = np.empty((self.count, len(motions), len(motions)))
        for i, motion in enumerate(motions):
            self._aim(0, motion)
            for j, other in enumerate(motions[: i + 1]):
                self._aim(1, other)
                out[:, i, j] = out[:, j, i] = self._per_body(self._block_form)
        if self._plate is not None:
            out[self._plate] -= self.load.inside_mpa() * self.plate_curvature(motions)
        return out

    @property
    def plate_axial(self) -> int | None:
        """Place of the plate's axial motion among the unknowns; None without a plate."""
        if self._plate is None:
            return None
        return self._plate * len(self.motions) + self.motions.index(AXIAL[0])

    def dead_forces(self) -> FloatArray:
        """Dead force on the body unknowns, N, shape (size,)."""
        out = np.zeros(self.size)
        if self.plate_axial is not None:
            out[self.plate_axial] = self.dead_force_n
        return out

    def plate_volume(self) -> tuple[float, FloatArray]:
        """What the plate adds to the integral of the cavity's walls to make it the enclosed volume.

        Returns
        -------
        tuple
            mm^3, and its derivative by the unknowns of all bodies, mm^2, shape (size,).
        """
        slope = np.zeros((self.count, len(self.motions)))
        if self._plate is None or self.motions == AXIAL:
            return 0.0, slope.ravel()
        volume, by_motion, _ = self._enclosed()
        slope[self._plate] = by_motion[list(self.motions)]
        return volume, slope.ravel()

    def plate_curvature(self, motions: Sequence[int]) -> FloatArray:
        """Second derivative of the same by motions of the plate, mm, shape (motions, motions)."""
        return self._enclosed()[2][np.ix_(list(motions), list(motions))]

    def _enclosed(self) -> tuple[float, FloatArray, FloatArray]:
        """See `solvers.bodies.plate.enclosed_by_plate`."""
        assert self._plate is not None
        six = as_six(self.values[[self._plate]], self.motions)[0]
        return enclosed_by_plate(six, self.arm_mm, self._plate_area)

    # ---- as a term -------------------------------------------------------------------------------------

    def energy(self) -> float:
        """Nothing: the bond's energy is an integral of the problem's form."""
        return 0.0

    def add_force(self, on_dofs: FloatArray, on_bodies: FloatArray) -> None:
        """Add the derivative by the bodies' unknowns, with the pressure and the dead force on a plate."""
        on_bodies += self.forces() - self.load.inside_mpa() * self.plate_volume()[1] - self.dead_forces()

    def pattern(self) -> scipy.sparse.csr_matrix:
        """Places of the bodies' border."""
        return self.border.pattern()

    def grow(self) -> bool:
        """False: bodies stay bonded where they are."""
        return False

    def add_to(self, matrix: Any) -> None:
        """Add the bodies' rows, columns and blocks."""
        held = self.is_held.reshape(self.values.shape)
        self.border.add(matrix, self.columns(self.motions), self.blocks(self.motions), held)

    def check(self) -> None:
        """Nothing to refuse."""

    def rms_slip_mm(self) -> float:
        """Root mean square slip, weighted with the bond's grade, mm."""
        area = compat.assemble_scalar(self._area_form, self.comm)
        return float(np.sqrt(compat.assemble_scalar(self._slip_form, self.comm) / area))


def _cells_of_bodies(domain: Domain, count: int) -> list[IntArray]:
    """Local cells at the bonded facets of each body."""
    mesh = domain.mesh
    mesh.topology.create_connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    to_cell = mesh.topology.connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    out = []
    for body in range(count):
        facets = domain.facet_tags.indices[domain.facet_bodies == body]
        out.append(np.unique(np.array([to_cell.links(f)[0] for f in facets], dtype=np.int64)))
    return out


def _nodal_function(domain: Domain, values: FloatArray) -> Any:
    """Quadratic scalar function from values at the caller's nodes."""
    space = compat.function_space(domain.mesh, ("Lagrange", 2))
    function = fem.Function(space)
    function.x.array[compat.cell_dofs(space)] = values[domain.input_node[compat.geometry_dofs(domain.mesh)]]
    function.x.scatter_forward()
    return function
