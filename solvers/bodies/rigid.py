"""Rigid bodies bonded to the solid by an elastic layer, with finite rotations.

A body k has a translation U and a rotation R = exp(w) about its centre c. A surface point X of the solid bonded to it
slips, in the body's frame, by

    e = R' (X - c + u - U) - (X - c),        energy 1/2 int g (kn (e.n)^2 + kt |e - (e.n) n|^2) dA

with n the reference normal, stiffnesses kn, kt per area and a grade g in [0, 1]. With a rotation increment
R -> R exp(W_j), variations for body unknown j (translation d_j, skew W_j) and test function v are

    e_v = R' v,   e_j = -W_j y - R' d_j,   e_vj = -W_j R' v,   e_ij = sym(W_i W_j) y + W_j R' d_i + W_i R' d_j

where y = e + X - c. The second variations matter: with linearised rotations the tractions of a pressurised wall on
the ring make torsion and tilting look unstable. On a meridian, and in a sector between planes of symmetry, a body
only moves axially.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from solvers import compat
from solvers.discrete.domain import Domain, FloatArray, IntArray
from solvers.discrete.kinematics import Kinematics


@dataclass(frozen=True)
class RigidBodies:
    """Rigid bodies bonded to the solid on the facets tagged as bonded.

    Attributes
    ----------
    normal_mpa_per_mm, tangential_mpa_per_mm
        Stiffness of the layer per area.
    grade
        Factor on both at each caller's node, shape (nodes,).
    centres_mm
        Axial position of each body's centre on the axis, shape (bodies,).
    arm_mm
        Length that turns rotations into displacements, so that all unknowns are in mm.
    axial_only
        True where symmetry leaves a body of a three-dimensional mesh only its axial motion, as in a sector.
    plate
        Number of the body that closes the cavity by a plane through its centre, normal to the axis; None for none.
    plate_area_mm2
        Area of that plane.
    plate_held
        True if the plate keeps the motion its state has: that of the unloaded state, nothing, on a path.
    plate_force_n
        Dead axial force on a plate that is not held, in the direction of the axis.
    """

    normal_mpa_per_mm: float
    tangential_mpa_per_mm: float
    grade: FloatArray
    centres_mm: FloatArray
    arm_mm: float
    axial_only: bool = False
    plate: int | None = None
    plate_area_mm2: float = 0.0
    plate_held: bool = False
    plate_force_n: float = 0.0


class BondedBodies:
    """Forms and small dense blocks of the bonded bodies of a problem.

    Parameters
    ----------
    domain, kin, space, state
        The mesh with its body numbers, kinematics, mixed space and state (u, p).
    bodies
        The bodies and their bond.
    measure
        Facet measure of the bonded surfaces, quadrature degree included.
    grade
        The bond's grade as a function on the mesh.
    """

    def __init__(
        self,
        domain: Domain,
        kin: Kinematics,
        space: Any,
        state: Any,
        bodies: RigidBodies,
        measure: Any,
        grade: Any,
    ) -> None:
        self.domain, self.comm = domain, domain.comm
        self.centres_mm = bodies.centres_mm
        self.arm_mm, self._plate, self._plate_area = bodies.arm_mm, bodies.plate, bodies.plate_area_mm2
        self.count = len(bodies.centres_mm)
        self.modes = 1 if domain.axisymmetric or bodies.axial_only else 6
        self.values = np.zeros((self.count, self.modes))
        held = np.zeros((self.count, self.modes), dtype=bool)
        if bodies.plate is not None and bodies.plate_held:
            held[bodies.plate] = True
        self.is_held = held.ravel()
        self.dead_force_n = 0.0 if bodies.plate is None or bodies.plate_held else bodies.plate_force_n
        mesh = domain.mesh
        self.cells = _cells_of_bodies(domain, self.count)
        self._index_map = space.dofmap.index_map
        normal = fem.Constant(mesh, bodies.normal_mpa_per_mm)
        tangential = fem.Constant(mesh, bodies.tangential_mpa_per_mm)

        self._translation = fem.Function(compat.function_space(mesh, ("DG", 0), (3,)))
        self._rotation = fem.Function(compat.function_space(mesh, ("DG", 0), (3, 3)))
        centre = fem.Function(compat.function_space(mesh, ("DG", 0), (3,)))
        axial = 1 if domain.axisymmetric else 2
        for body, cells in enumerate(self.cells):
            centre.x.array.reshape(-1, 3)[cells, axial] = bodies.centres_mm[body]
        self._shifts = [fem.Constant(mesh, np.zeros(3)) for _ in range(2)]
        self._spins = [fem.Constant(mesh, np.zeros(3)) for _ in range(2)]

        u, v, du = (kin.three(ufl.split(f)[0]) for f in (state, ufl.TestFunction(space), ufl.TrialFunction(space)))
        arm = kin.three(kin.position) - centre
        back = self._rotation.T
        y = back * (arm + u - self._translation)
        n = kin.normal
        weight = grade * kin.measure

        def traction(e: Any) -> Any:
            along = ufl.inner(e, n) * n
            return normal * along + tangential * (e - along)

        def first(k: int) -> Any:
            return -ufl.cross(self._spins[k], y) - back * self._shifts[k]

        slip = y - arm
        pull = traction(slip)
        # what the harmonics of an axisymmetric state need of the bond
        self.arm, self.slip, self.traction, self.grade, self.measure = arm, slip, traction, grade, measure
        s0, s1 = self._spins
        d0, d1 = (back * shift for shift in self._shifts)
        second = (
            0.5 * (ufl.cross(s0, ufl.cross(s1, y)) + ufl.cross(s1, ufl.cross(s0, y)))
            + ufl.cross(s1, d0)
            + ufl.cross(s0, d1)
        )
        self.energy = 0.5 * ufl.inner(pull, slip) * weight * measure
        self.force = ufl.inner(pull, back * v) * weight * measure
        self.stiffness = ufl.inner(traction(back * du), back * v) * weight * measure
        per_cell = compat.function_space(mesh, ("DG", 0))
        pick = ufl.TestFunction(per_cell)
        self._cell_map = per_cell.dofmap.index_map
        column = (ufl.inner(traction(first(0)), back * v) - ufl.inner(pull, ufl.cross(s0, back * v))) * weight * measure
        block = (ufl.inner(traction(first(0)), first(1)) + ufl.inner(pull, second)) * pick * weight * measure
        self._column_form = compat.compile_form(column)
        self._block_form = compat.compile_form(block)
        self._force_form = compat.compile_form(ufl.inner(pull, first(0)) * pick * weight * measure)
        self._slip_form = compat.compile_form(ufl.inner(slip, slip) * weight * measure)
        self._area_form = compat.compile_form(weight * measure)
        self._axial = axial
        self.update(np.zeros(0))

    @property
    def size(self) -> int:
        """Number of body unknowns."""
        return self.count * self.modes

    def _aim(self, k: int, mode: int) -> None:
        """Set direction k to a body unknown."""
        self._shifts[k].value[:] = 0.0
        self._spins[k].value[:] = 0.0
        if self.modes == 1:
            self._shifts[k].value[self._axial] = 1.0
        elif mode < 3:
            self._shifts[k].value[mode] = 1.0
        else:
            self._spins[k].value[mode - 3] = 1.0 / self.arm_mm

    def update(self, step: FloatArray) -> None:
        """Move the bodies by an increment of their unknowns, shape (size,) (empty: refresh the fields only)."""
        if len(step):
            change = step.reshape(self.values.shape)
            self.values[:] = moved(self.values, change, self.arm_mm)
        for body, cells in enumerate(self.cells):
            value = self.values[body]
            shift = np.zeros(3)
            turn = np.eye(3)
            if self.modes == 1:
                shift[self._axial] = value[0]
            else:
                shift[:] = value[:3]
                turn = Rotation.from_rotvec(value[3:] / self.arm_mm).as_matrix()
            self._translation.x.array.reshape(-1, 3)[cells] = shift
            self._rotation.x.array.reshape(-1, 9)[cells] = turn.ravel()

    def turns(self) -> FloatArray:
        """Rotations of the bodies, shape (bodies, 3, 3); only for bodies with all six motions."""
        return np.asarray(Rotation.from_rotvec(self.values[:, 3:] / self.arm_mm).as_matrix())

    def _per_body(self, form: Any) -> FloatArray:
        values = compat.assemble_array(form, self._cell_map).array
        return self.comm.allreduce(np.array([values[c].sum() for c in self.cells]), op=MPI.SUM)

    def forces(self) -> FloatArray:
        """Derivative of the bond energy with respect to the body unknowns, shape (size,)."""
        out = np.empty((self.count, self.modes))
        for mode in range(self.modes):
            self._aim(0, mode)
            out[:, mode] = self._per_body(self._force_form)
        return out.ravel()

    def columns(self) -> FloatArray:
        """Coupling of dofs and modes, all bodies added up, on the owned dofs, shape (owned, modes)."""
        owned = self._index_map.size_local
        out = np.empty((owned, self.modes))
        for mode in range(self.modes):
            self._aim(0, mode)
            out[:, mode] = compat.assemble_array(self._column_form, self._index_map).array[:owned]
        return out

    def blocks(self) -> FloatArray:
        """Second derivative of the bond energy in the unknowns of each body, shape (bodies, modes, modes)."""
        out = np.empty((self.count, self.modes, self.modes))
        for i in range(self.modes):
            self._aim(0, i)
            for j in range(i + 1):
                self._aim(1, j)
                out[:, i, j] = out[:, j, i] = self._per_body(self._block_form)
        return out

    @property
    def plate_axial(self) -> int | None:
        """Place of the plate's axial motion among the unknowns; None without a plate."""
        if self._plate is None:
            return None
        return self._plate * self.modes + (2 if self.modes == 6 else 0)

    def dead_forces(self) -> FloatArray:
        """Dead force on the body unknowns, N, shape (size,)."""
        out = np.zeros(self.size)
        if self.plate_axial is not None:
            out[self.plate_axial] = self.dead_force_n
        return out

    def plate_volume(self) -> tuple[float, FloatArray, FloatArray]:
        """What the plate adds to the integral of the cavity's walls to make it the enclosed volume.

        With the field (x, y, 0)/2 the plate's face contributes ``A/2 U . n`` (transverse parts), n = R e_z its normal:
        nothing as long as it keeps level or on the axis, but its second variation couples tilting and drifting.

        Returns
        -------
        tuple
            mm^3; its derivative by the unknowns, mm^2, shape (size,); its second derivative in each body, mm,
            shape (bodies, modes, modes).
        """
        slope, curvature = np.zeros((self.count, self.modes)), np.zeros((self.count, self.modes, self.modes))
        if self._plate is None or self.modes == 1:
            return 0.0, slope.ravel(), curvature
        value = self.values[self._plate]
        half = 0.5 * self._plate_area
        turn = Rotation.from_rotvec(value[3:] / self.arm_mm).as_matrix()
        spins = [np.cross(axis, np.eye(3)).T / self.arm_mm for axis in np.eye(3)]  # W_j, with W_j y = e_j x y / arm
        across = np.array([value[0], value[1], 0.0])
        flat = np.diag([1.0, 1.0, 0.0])
        up = np.array([0.0, 0.0, 1.0])
        tilt = np.stack([turn @ w @ up for w in spins], axis=1)  # dn by rotations, columns
        first, second = slope[self._plate], curvature[self._plate]
        first[:3], first[3:] = half * flat @ turn @ up, half * across @ tilt
        second[:3, 3:] = half * flat @ tilt
        second[3:, :3] = second[:3, 3:].T
        for i in range(3):
            for j in range(3):
                both = 0.5 * (spins[i] @ spins[j] + spins[j] @ spins[i])
                second[3 + i, 3 + j] = half * across @ turn @ both @ up
        return float(half * across @ turn @ up), slope.ravel(), curvature

    def rms_slip_mm(self) -> float:
        """Root mean square slip, weighted with the bond's grade, mm."""
        area = compat.assemble_scalar(self._area_form, self.comm)
        return float(np.sqrt(compat.assemble_scalar(self._slip_form, self.comm) / area))


def moved(values: FloatArray, change: FloatArray, arm_mm: float) -> FloatArray:
    """Body unknowns after an increment: translations add, rotations multiply from the right."""
    out = values + change
    if values.shape[1] == 6:
        for k in range(len(values)):
            turn = Rotation.from_rotvec(values[k, 3:] / arm_mm) * Rotation.from_rotvec(change[k, 3:] / arm_mm)
            out[k, 3:] = turn.as_rotvec() * arm_mm
    return out


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
