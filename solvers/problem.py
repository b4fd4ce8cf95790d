"""A boundary value problem on a domain: spaces, compiled forms, constraints, rigid rings, assembly.

Unknowns are the mixed finite-element dofs and, after them, the motions of rigid bodies bonded to the solid by
an elastic layer. Bodies enter the tangent as bordering rows and columns of one symmetric sparse matrix, so one
factorisation serves all and its inertia counts them too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from analytical.laws.stiff import StiffSolid
from solvers import compat
from solvers.bodies.rigid import BondedBodies, RigidBodies
from solvers.bodies.turning import Turning
from solvers.discrete.domain import Domain, FloatArray, IntArray
from solvers.discrete.elements import QUADRATURE_DEGREE, Element, usual_element
from solvers.discrete.kinematics import kinematics
from solvers.energy.forms import build_forms, invariants
from solvers.energy.laws import Law, compile_law
from solvers.energy.loads import DEAD, LoadKind, load_forms, load_tangent
from solvers.errors import SolverError
from solvers.state import State, Timer

if TYPE_CHECKING:
    from solvers.contact.contact import Contact

SOFT, STIFF = 1, 2  # material numbers of cells

# Potential and traction form of a load are one load if their work on random directions differs by less than this.
SAME_LOAD = 1e-10
# The cells fill what their surface encloses up to this share: the quadrature is exact for both on quadratic cells.
SAME_SIZE = 1e-9


@dataclass(frozen=True)
class Surfaces:
    """Facet numbers of the surfaces with a role; None where there is none.

    Attributes
    ----------
    cavity, external, dead, dead_pressure, dead_shear
        The loaded surface, exactly one of these and ``suction``: by a pressure from inside, by a pressure from outside
        (both follow the surface), or by a tension or a pressure along the reference normal, or a traction along the
        second direction, that keeps its direction.
    clamped
        All displacement components are zero.
    bond
        Bonded to rigid bodies.
    held
        Pairs (facet number, component) with zero displacement: symmetry planes, the axis of a meridian, rollers.
        Components are those of the problem's frame.
    pinned
        Pairs (caller's node, component) with zero displacement, to hold a free body's motions.
    blocked
        Held axially, and the force on what holds it is known: `Problem.end_force`.
    suction
        Loaded by a vacuum inside, which follows the surface.
    """

    cavity: int | None = None
    clamped: int | None = None
    bond: int | None = None
    held: tuple[tuple[int, int], ...] = ()
    external: int | None = None
    dead: int | None = None
    pinned: tuple[tuple[int, int], ...] = ()
    dead_pressure: int | None = None
    blocked: int | None = None
    dead_shear: int | None = None
    suction: int | None = None

    @property
    def load(self) -> tuple[LoadKind, int]:
        """Kind and facet number of the load.

        Raises
        ------
        SolverError
            If there is none or more than one.
        """
        kinds: dict[LoadKind, int | None] = {
            "cavity": self.cavity,
            "suction": self.suction,
            "external": self.external,
            "dead": self.dead,
            "dead_pressure": self.dead_pressure,
            "dead_shear": self.dead_shear,
        }
        given = [(kind, number) for kind, number in kinds.items() if number is not None]
        if len(given) != 1:
            raise SolverError(f"a problem needs one loaded surface, got {len(given)}: set one of {', '.join(kinds)}")
        return given[0]


class Problem:
    """Assembled equations of one domain, material and set of rigid bodies.

    Parameters
    ----------
    domain
        Mesh; its cell tags are SOFT or STIFF.
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
    ) -> None:
        compat.align_counters()
        self.domain, self.comm = domain, domain.comm
        self.surfaces, self.stiff, self.bodies, self.inverse_kappa = surfaces, stiff, bodies, float(inverse_kappa)
        self.contact: Contact | None = None
        self.timer = Timer()
        mesh = domain.mesh
        self.dimension = mesh.geometry.dim
        self.element = element or usual_element(domain.cell_name)
        self.space = compat.function_space(mesh, self.element.spaces(mesh.ufl_cell()))
        self.state = fem.Function(self.space)
        self.pressure = fem.Constant(mesh, 0.0)
        self.index_map = self.space.dofmap.index_map
        self._number_unknowns()

        self.quadrature_degree = degree = quadrature_degree or QUADRATURE_DEGREE[domain.cell_name]
        assert frame is None or bodies is None
        self.frame = np.eye(self.dimension) if frame is None else frame
        kin = kinematics(mesh, domain.axisymmetric, None if frame is None else fem.Constant(mesh, frame))
        dx, ds = domain.dx(degree=degree), domain.ds(degree=degree)
        with self.timer("compile"):
            self._refuse_overlaps()
        if stiff is None:
            measures = {"soft": ufl.dx(domain=mesh, degree=degree)}
        else:
            measures = {"soft": dx(SOFT), "stiff": dx(STIFF)}
        self.law = compile_law(law, mesh)
        with self.timer("compile"):
            forms = build_forms(
                self.space,
                self.state,
                kin,
                self.law,
                fem.Constant(mesh, float(inverse_kappa)),
                stiff,
                measures,
            )
            kind, loaded = surfaces.load
            self._plate_sense = -1.0 if kind == "suction" else 1.0
            # UFL takes arguments made after a compilation for others than those made before: all forms come first, and
            # those of the bodies, which compile some, last.
            load = load_forms(kind, self.space, self.state, kin, ds(loaded))
            tangents = {
                conservative: load_tangent(
                    forms.tangent, load, kind, conservative, self.space, self.state, self.pressure
                )
                for conservative in (True, False)
            }
            self.bonded = None
            if bodies is not None and surfaces.bond is not None:
                grade = self._nodal_function(bodies.grade)
                at = ds(surfaces.bond)
                self.bonded = BondedBodies(domain, kin, self.space, self.state, bodies, at, grade)
                forms = replace(
                    forms,
                    internal_force=forms.internal_force + self.bonded.force,
                    energy=forms.energy + self.bonded.energy,
                )
                tangents = {key: form + self.bonded.stiffness for key, form in tangents.items()}
            self._internal = compat.compile_form(forms.internal_force)
            self._energy = compat.compile_form(forms.energy)
            self._volume = compat.compile_form(load.volume)
            self._volume_gradient = compat.compile_form(load.volume_gradient)
            self._traction_load = compat.compile_form(load.traction)
            k = invariants(kin.gradient(ufl.split(self.state)[0]))
            points = compat.quadrature_points(domain.cell_name, degree)
            self._check = compat.compile_expression(ufl.as_vector([k.j, k.i1, k.i2]), points)
            self._points = points

            q = ufl.TestFunctions(self.space)[1]
            unit_form = compat.compile_form(q * kin.measure * ufl.dx(domain=mesh, degree=degree))

        self._constrain(surfaces, stiff is not None)
        # A plate closes the cavity and its rim moves: the potential is the load, the wall's traction only a part of it.
        closed = bodies is not None and bodies.plate is not None
        self.conservative = closed or self._load_difference() <= SAME_LOAD
        with self.timer("compile"):
            self._tangent = compat.compile_form(tangents[self.conservative])
        self.extra = 0 if self.bonded is None else self.bonded.size
        self.modes = 0 if self.bonded is None else self.bonded.modes
        self._coupled = self._coupled_dofs()
        self.turning = self._turning(bodies)
        self.constrained_owned = self._is_constrained[: self.owned]
        self.shear_modulus_mpa = float(law.initial_shear_modulus_mpa)
        self.inverse_kappa = float(inverse_kappa)
        self.volume_measure = (kin.measure, ufl.dx(domain=mesh, degree=degree))
        unit = compat.assemble_array(unit_form, self.index_map).array[: self.owned]
        self.volume_scale = float(np.sqrt(self.comm.allreduce(float(unit @ unit), op=MPI.SUM)))
        # what volumes are measured by: the unloaded one, or the body's where the load encloses none
        body = float(self.comm.allreduce(float(unit.sum()), op=MPI.SUM))
        self.volume_unit_mm3 = body if kind in DEAD else abs(self.cavity_volume())
        self.expected_negatives = int(
            self.comm.allreduce(int((self.owned_pressure & ~self.constrained_owned).sum()), op=MPI.SUM)
        )

    def _refuse_overlaps(self) -> None:
        """Refuse cells that fold over or overlap: by Gauss' theorem cells fill what their surface encloses."""
        mesh, degree = self.domain.mesh, QUADRATURE_DEGREE[self.domain.cell_name]
        x, normal = ufl.SpatialCoordinate(mesh), ufl.FacetNormal(mesh)
        # the sizes of cells are never negative, so what is folded over is counted twice
        one = fem.Constant(mesh, 1.0) * ufl.dx(domain=mesh, degree=degree)
        flux = ufl.inner(x, normal) / self.dimension * ufl.ds(domain=mesh, degree=degree)
        filled, enclosed = (compat.assemble_scalar(compat.compile_form(form), self.comm) for form in (one, flux))
        if not abs(filled - enclosed) <= SAME_SIZE * abs(enclosed):
            unit = f"mm^{self.dimension}"
            raise SolverError(
                f"cells of the mesh fold over or overlap: they fill {filled:.9g} {unit}, their surface encloses "
                f"{enclosed:.9g}: mesh it anew, or look for a flipped cell or one with a corner beyond its neighbours"
            )

    # ---- the load --------------------------------------------------------------------------------------

    def _load_difference(self) -> float:
        """Largest difference of the load as potential and as traction, relative to the work that cancels in it.

        The Hessian of the potential is symmetric on any surface, so symmetry proves nothing: the two forces are
        compared on random directions that respect the constraints, at a random state that does too.
        """
        rng = np.random.default_rng([17, self.comm.rank])
        box = np.ptp(self.domain.mesh.geometry.x, axis=0).max(initial=0.0)
        size = 0.01 * self.comm.allreduce(float(box), op=MPI.MAX)
        free = ~self._is_constrained[: self.owned]
        self.state.x.array[: self.owned] = size * rng.standard_normal(self.owned) * free
        self.state.x.scatter_forward()
        potential, traction = self.volume_gradient(), self.load_traction()
        self.state.x.array[:] = 0.0
        directions = rng.standard_normal((5, self.owned)) * free
        different = self.comm.allreduce(directions @ (potential - traction), op=MPI.SUM)
        whole = self.comm.allreduce(np.abs(directions) @ np.abs(traction), op=MPI.SUM)
        return float((np.abs(different) / np.maximum(whole, np.finfo(float).tiny)).max())

    # ---- numbering -------------------------------------------------------------------------------------

    def _number_unknowns(self) -> None:
        """Local dofs: displacements of each local geometry node (n, d), -1 where it has none; pressures.

        A continuous pressure belongs to corner nodes, ``p_dofs`` (n,), -1 elsewhere. One with jumps belongs to cells,
        ``p_dofs`` (owned cells, k), and ``_p_at_corners`` (corners, k) holds its basis functions there.
        """
        mesh, corners = self.domain.mesh, self.domain.corners
        geometry = compat.geometry_dofs(mesh)
        count = len(self.domain.input_node)
        self.u_dofs = np.full((count, self.dimension), -1, dtype=np.int64)
        for i in range(self.dimension):
            dofs = compat.cell_dofs(self.space.sub(0).sub(i))
            self.u_dofs[geometry[:, : dofs.shape[1]], i] = dofs
        # linear displacements at the quadratic nodes, for callers who expect a value at every node
        linear = compat.element("Lagrange", mesh.ufl_cell(), 1)
        self._linear_at_nodes = compat.basis_at(linear, compat.node_positions(self.domain.cell_name))
        on_cells = compat.cell_dofs(self.space.sub(1))
        if self.element.pressure == "continuous":
            self.p_dofs = np.full(count, -1, dtype=np.int64)
            self.p_dofs[geometry[:, :corners]] = on_cells
            self.pressure_shape: tuple[int, ...] = (self.domain.nodes,)
        else:
            self.p_dofs = on_cells.astype(np.int64)
            scalar = compat.sub_elements(self.space.ufl_element())[1]
            self._p_at_corners = compat.basis_at(scalar, compat.corner_positions(self.domain.cell_name))
            self.pressure_shape = (self.domain.cells, corners)
        self.owned = self.index_map.size_local
        self.local = self.owned + self.index_map.num_ghosts
        self.owned_pressure = np.zeros(self.owned, dtype=bool)
        owned_p = self.p_dofs[(self.p_dofs >= 0) & (self.p_dofs < self.owned)]
        self.owned_pressure[owned_p] = True

    def _nodal_function(self, values: FloatArray) -> Any:
        """Quadratic scalar function from values at the caller's nodes."""
        space = compat.function_space(self.domain.mesh, ("Lagrange", 2))
        function = fem.Function(space)
        geometry = compat.geometry_dofs(self.domain.mesh)
        function.x.array[compat.cell_dofs(space)] = values[self.domain.input_node[geometry]]
        function.x.scatter_forward()
        return function

    def _constrain(self, surfaces: Surfaces, has_stiff: bool) -> None:
        """Dirichlet conditions: clamped and held surfaces, no pressure unknowns in stiff cells."""
        tags, axial = self.domain.facet_tags, self.dimension - 1
        conditions = list(surfaces.held)
        if surfaces.clamped is not None:
            conditions += [(surfaces.clamped, i) for i in range(self.dimension)]
        if surfaces.blocked is not None:
            conditions.append((surfaces.blocked, axial))
        fixed: list[tuple[Any, IntArray]] = []
        for number, component in conditions:
            sub = self.space.sub(0).sub(component)
            facets = tags.indices[tags.values == number]
            fixed.append((sub, fem.locate_dofs_topological(sub, self.dimension - 1, facets)))
        if has_stiff:
            cell_tags = self.domain.cell_tags
            cells = compat.cell_dofs(self.space.sub(1))
            is_soft = np.zeros(len(cells), dtype=bool)
            owned_soft = cell_tags.indices[cell_tags.values == SOFT]
            is_soft[owned_soft[owned_soft < len(cells)]] = True
            # a dof is soft if any rank has a soft cell at it: sum on the owner, then back to the ghosts
            touched = fem.Function(self.space)
            touched.x.array[cells[is_soft].ravel()] = 1.0
            compat.sum_on_owners(touched.x)
            touched.x.scatter_forward()
            soft = touched.x.array > 0.0
            pressure = np.unique(self.p_dofs[self.p_dofs >= 0])
            dead = pressure[~soft[pressure]]
            fixed.append((self.space.sub(1), np.unique(dead).astype(np.int32)))
        for node, component in surfaces.pinned:
            dofs = self.u_dofs[self.domain.input_node == node, component]
            fixed.append((self.space.sub(0).sub(component), dofs[dofs >= 0]))
        self.bcs = [fem.dirichletbc(PETSc.ScalarType(0), np.asarray(d, np.int32), s) for s, d in fixed]
        self._is_constrained = np.zeros(self.local, dtype=bool)
        for _, dofs in fixed:
            self._is_constrained[dofs] = True
        self._clamped_axial = self._axial_dofs(surfaces.clamped)
        self._blocked_axial = None if surfaces.blocked is None else self._axial_dofs(surfaces.blocked)

    def _axial_dofs(self, surface: int | None) -> IntArray:
        """Owned axial dofs on a surface."""
        facets = self.domain.facet_tags.indices[self.domain.facet_tags.values == surface]
        dofs = fem.locate_dofs_topological(self.space.sub(0).sub(self.dimension - 1), self.dimension - 1, facets)
        return dofs[dofs < self.owned].astype(np.int64)

    # ---- rigid bodies ----------------------------------------------------------------------------------

    def _coupled_dofs(self) -> list[IntArray]:
        """Owned displacement dofs bonded to each body."""
        if self.bonded is None:
            return []
        tags, pulled = self.domain.facet_tags, []
        for body in range(self.bonded.count):
            facets = tags.indices[self.domain.facet_bodies == body]
            found = np.zeros(self.owned, dtype=bool)
            for i in range(self.dimension):
                dofs = fem.locate_dofs_topological(self.space.sub(0).sub(i), self.dimension - 1, facets)
                found[dofs[dofs < self.owned]] = True
            # cells between two bodies have dofs of both, their bonded facets never
            pulled.append(np.flatnonzero(found & ~self._is_constrained[: self.owned]))
        return pulled

    def _turning(self, bodies: RigidBodies | None) -> Turning | None:
        """The bonded points of bodies that can turn; a point is its owner's."""
        if bodies is None or self.modes != 6:
            return None
        dofs, positions = [], []
        free = (self.u_dofs >= 0).all(axis=1) & (self.u_dofs < self.owned).all(axis=1)
        for pulled in self._coupled:
            nodes = np.flatnonzero(free & np.isin(self.u_dofs, pulled).all(axis=1))
            dofs.append(self.u_dofs[nodes])
            positions.append(np.asarray(self.domain.mesh.geometry.x[nodes]))
        return Turning(dofs, positions, np.asarray(bodies.centres_mm), bodies.arm_mm)

    @property
    def held_bodies(self) -> NDArray[np.bool_]:
        """Which body unknowns are held, shape (extra,)."""
        return np.zeros(0, dtype=bool) if self.bonded is None else self.bonded.is_held

    @property
    def body_values(self) -> FloatArray:
        """Body unknowns, mm, shape (bodies, modes)."""
        return np.zeros((0, 0)) if self.bonded is None else self.bonded.values

    # ---- assembly --------------------------------------------------------------------------------------

    def new_matrix(self) -> PETSc.Mat:
        """Empty matrix with the pattern of the tangent and the bodies' border, theirs on the last rank."""
        total = self.index_map.size_global
        size = total + self.extra
        last = self.comm.rank == self.comm.size - 1
        pattern = compat.cell_pattern(self.space)
        pattern.resize((self.owned, size))
        if self.bonded is not None:
            row = np.concatenate([np.repeat(d, self.modes) for d in self._coupled])
            column = np.concatenate(
                [np.tile(np.arange(k * self.modes, (k + 1) * self.modes), len(d)) for k, d in enumerate(self._coupled)]
            )
            here = (np.ones(len(row), np.int8), (row, total + column))
            pattern = pattern + scipy.sparse.csr_matrix(here, shape=(self.owned, size))
            first = self.index_map.local_range[0]
            pairs = self.comm.gather((column, row + first), root=self.comm.size - 1)
            if last and pairs is not None:
                body = np.concatenate([a for a, _ in pairs] + [np.repeat(np.arange(self.extra), self.extra)])
                dof = np.concatenate([b for _, b in pairs] + [np.tile(np.arange(total, size), self.extra)])
                there = (np.ones(len(body), np.int8), (body, dof))
                below = scipy.sparse.csr_matrix(there, shape=(self.extra, size))
                pattern = scipy.sparse.vstack([pattern, below], format="csr")
        if self.contact is not None:
            pattern = pattern + self.contact.pattern
        pattern.sort_indices()
        rows = self.owned + (self.extra if last else 0)
        matrix = PETSc.Mat().createAIJ(
            size=((rows, size), (rows, size)),
            csr=(
                pattern.indptr.astype(PETSc.IntType),
                pattern.indices.astype(PETSc.IntType),
                np.zeros(pattern.nnz),
            ),
            comm=self.comm,
        )
        local_to_global = np.concatenate(
            [self.index_map.local_to_global(np.arange(self.local, dtype=np.int32)), np.arange(total, size)]
        ).astype(PETSc.IntType)
        lgmap = PETSc.LGMap().create(local_to_global, comm=self.comm)
        matrix.setLGMap(lgmap, lgmap)
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, self.conservative)
        # Finding its place costs an entry more than computing it, and nine in ten entries of a facet's are zeros.
        matrix.setOption(PETSc.Mat.Option.IGNORE_ZERO_ENTRIES, True)
        return matrix

    def assemble_tangent(self, matrix: PETSc.Mat) -> None:
        """Tangent at the current state, into ``matrix``."""
        with self.timer("tangent"):
            matrix.zeroEntries()
            compat.assemble_into(matrix, self._tangent, self.bcs, self.space)
            if self.bonded is not None:
                matrix.assemblyBegin(PETSc.Mat.AssemblyType.FLUSH)
                matrix.assemblyEnd(PETSc.Mat.AssemblyType.FLUSH)
                self._add_border(matrix, self.bonded)
            if self.contact is not None:
                matrix.assemblyBegin(PETSc.Mat.AssemblyType.FLUSH)
                matrix.assemblyEnd(PETSc.Mat.AssemblyType.FLUSH)
                self.contact.add_to(matrix)
            matrix.assemble()

    def _add_border(self, matrix: PETSc.Mat, bonded: BondedBodies) -> None:
        """Add the bodies' rows, columns and blocks."""
        first, total = self.index_map.local_range[0], self.index_map.size_global
        columns = bonded.columns()
        blocks = bonded.blocks() - self._plate_sense * float(self.pressure.value) * bonded.plate_volume()[2]
        add = PETSc.InsertMode.ADD_VALUES
        held = bonded.is_held.reshape(bonded.count, bonded.modes).any(axis=1)
        for body, dofs in enumerate(self._coupled):
            if held[body]:  # a unit diagonal alone: it stays where it is, and adds no negative pivot
                if self.comm.rank == self.comm.size - 1:
                    there = np.arange(self.modes, dtype=PETSc.IntType) + (total + body * self.modes)
                    matrix.setValues(there, there, np.eye(self.modes), addv=add)
                continue
            here = (dofs + first).astype(PETSc.IntType)
            there = np.arange(self.modes, dtype=PETSc.IntType) + (total + body * self.modes)
            values = columns[dofs]
            matrix.setValues(here, there, values, addv=add)
            matrix.setValues(there, here, np.ascontiguousarray(values.T), addv=add)
            if self.comm.rank == self.comm.size - 1:
                matrix.setValues(there, there, blocks[body], addv=add)

    def internal_force(self) -> tuple[FloatArray, FloatArray]:
        """Internal force on the owned dofs (owned,), residual of the bodies (extra,); constraints not yet applied.

        The bodies' residual includes the pressure and the dead force on a plate.
        """
        with self.timer("residual"):
            force = compat.assemble_array(self._internal, self.index_map).array[: self.owned].copy()
            on_bodies = np.zeros(0)
            if self.bonded is not None:
                on_plate = self._plate_sense * float(self.pressure.value) * self.bonded.plate_volume()[1]
                on_bodies = self.bonded.forces() - on_plate - self.bonded.dead_forces()
            if self.contact is not None:
                push = self.contact.force()
                force, on_bodies = force + push[: self.owned], on_bodies + push[self.owned :]
            return force, on_bodies

    def volume_gradient(self) -> FloatArray:
        """Derivative of `cavity_volume` on the owned dofs, mm^2, shape (owned,)."""
        with self.timer("residual"):
            return compat.assemble_array(self._volume_gradient, self.index_map).array[: self.owned].copy()

    def load_traction(self) -> FloatArray:
        """Force of a unit load on the owned dofs without use of the potential, mm^2, shape (owned,)."""
        with self.timer("residual"):
            return compat.assemble_array(self._traction_load, self.index_map).array[: self.owned].copy()

    def load_force(self) -> FloatArray:
        """Force of a unit load on the owned dofs, mm^2: from the potential where that is the load."""
        return self.volume_gradient() if self.conservative else self.load_traction()

    def cavity_volume(self) -> float:
        """Volume on which the load does work, mm^3: enclosed for a cavity; see solvers.energy.loads for others."""
        by_plate = 0.0 if self.bonded is None else self._plate_sense * self.bonded.plate_volume()[0]
        return compat.assemble_scalar(self._volume, self.comm) + by_plate

    def energy(self) -> float:
        """Stored energy of solid, bond and contact, mJ."""
        stored = compat.assemble_scalar(self._energy, self.comm)
        return stored if self.contact is None else stored + self.contact.energy()

    def reaction(self) -> float:
        """Axial force of the support on the clamped surface, N.

        Uses the traction form: the potential's derivative differs from it on the clamped edge.
        """
        force, _ = self.internal_force()
        total = force - float(self.pressure.value) * self.load_traction()
        return float(self.comm.allreduce(float(total[self._clamped_axial].sum()), op=MPI.SUM))

    def end_force(self) -> float:
        """Axial force of the body on what acts at its end, N: on what holds a plate or a blocked surface.

        Positive along the axis. For a free plate the opposite of the dead force on it; 0 without any of these.
        """
        if self._blocked_axial is not None:
            force, _ = self.internal_force()
            total = force - float(self.pressure.value) * self.load_traction()
            return -float(self.comm.allreduce(float(total[self._blocked_axial].sum()), op=MPI.SUM))
        if self.bonded is None or self.bonded.plate_axial is None:
            return 0.0
        if self.bonded.is_held[self.bonded.plate_axial]:
            return -float(self.internal_force()[1][self.bonded.plate_axial])
        return 0.0 - self.bonded.dead_force_n

    def extremes(self) -> tuple[float, float, float]:
        """Smallest det F and largest isochoric I1 and I2 over all quadrature points (NaN-safe)."""
        with self.timer("checks"):
            cells = np.arange(self.domain.mesh.topology.index_map(self.dimension).size_local, dtype=np.int32)
            values = compat.evaluate(self._check, self.domain.mesh, cells).reshape(-1, 3)
            j, i1, i2 = np.inf, 0.0, 0.0
            if len(values):
                j = float(np.min(values[:, 0])) if np.isfinite(values).all() else -np.inf
                i1, i2 = float(np.max(values[:, 1])), float(np.max(values[:, 2]))
            return (
                self.comm.allreduce(j, op=MPI.MIN),
                self.comm.allreduce(i1, op=MPI.MAX),
                self.comm.allreduce(i2, op=MPI.MAX),
            )

    def worst_cell(self) -> str:
        """The smallest det F, and where its quadrature point is in the unloaded body."""
        here = compat.compile_expression(ufl.SpatialCoordinate(self.domain.mesh), self._points)
        cells = np.arange(self.domain.mesh.topology.index_map(self.dimension).size_local, dtype=np.int32)
        values = compat.evaluate(self._check, self.domain.mesh, cells).reshape(-1, 3)[:, 0]
        values = np.where(np.isfinite(values), values, -np.inf)
        found = []
        if len(values):
            worst = int(np.argmin(values))
            tags = self.domain.cell_tags
            region = int(tags.values[tags.indices == worst // len(self._points)][0])
            found = [
                (
                    float(values[worst]),
                    compat.evaluate(here, self.domain.mesh, cells).reshape(-1, self.dimension)[worst],
                    region,
                )
            ]
        det_f, at, region = min((f for part in self.comm.allgather(found) for f in part), key=lambda f: f[0])
        names = ("r", "z") if self.domain.axisymmetric else ("x", "y", "z")
        place = ", ".join(f"{name} = {value:.2f}" for name, value in zip(names, at, strict=True))
        return f"det F = {det_f:.3g} at {place} mm, {'soft' if region == SOFT else 'stiff'} region"

    # ---- states ----------------------------------------------------------------------------------------

    def set_state(self, state: State) -> None:
        """Make a state in the caller's numbering the current one; constraints are imposed exactly."""
        array = self.state.x.array
        known = self.u_dofs[:, 0] >= 0
        components = state.displacement_mm[self.domain.input_node[known]] @ np.linalg.inv(self.frame).T
        for i in range(self.dimension):
            array[self.u_dofs[known, i]] = components[:, i]
        if state.pressure_mpa.shape != self.pressure_shape:
            raise SolverError(f"state has pressures of shape {state.pressure_mpa.shape}, need {self.pressure_shape}")
        if self.element.pressure == "continuous":
            corner = self.p_dofs >= 0
            array[self.p_dofs[corner]] = state.pressure_mpa[self.domain.input_node[corner]]
        else:
            # the closest polynomial to the corner values: exact for those of a state of this problem
            mine = state.pressure_mpa[self.domain.input_cell[: len(self.p_dofs)]]
            array[self.p_dofs] = mine @ np.linalg.pinv(self._p_at_corners).T
        array[: self.local][self._is_constrained] = 0.0
        self.state.x.scatter_forward()
        if state.bodies_mm.shape != self.body_values.shape:
            raise SolverError(f"state has bodies of shape {state.bodies_mm.shape}, need {self.body_values.shape}")
        if self.bonded is not None:
            self.bonded.values[:] = state.bodies_mm
            self.bonded.update(np.zeros(0))
        self.pressure.value = state.load_mpa

    def get_state(self) -> State:
        """The current state in the caller's numbering, complete on every rank."""
        domain, array = self.domain, self.state.x.array
        known = self.u_dofs[:, 0] >= 0
        u = np.zeros((len(known), self.dimension))
        u[known] = array[self.u_dofs[known]] @ self.frame.T
        if self.element.displacement_degree == 1:
            geometry = compat.geometry_dofs(domain.mesh)
            u[geometry] = np.einsum("nk,cki->cni", self._linear_at_nodes, u[geometry[:, : domain.corners]])
            known = np.isin(np.arange(len(known)), geometry)
        if self.element.pressure == "continuous":
            at = np.flatnonzero(self.p_dofs >= 0)
            where, p = domain.input_node[at], array[self.p_dofs[at]]
        else:
            where, p = domain.input_cell[: len(self.p_dofs)], array[self.p_dofs] @ self._p_at_corners.T
        displacement = np.zeros((domain.nodes, self.dimension))
        pressure = np.zeros(self.pressure_shape)
        for nodes, values, places, p_values in self.comm.allgather((domain.input_node[known], u[known], where, p)):
            displacement[nodes] = values
            pressure[places] = p_values
        return State(displacement, pressure, self.body_values.copy(), float(self.pressure.value))

    def zero_state(self) -> State:
        """The unloaded reference state."""
        return State(
            np.zeros((self.domain.nodes, self.dimension)),
            np.zeros(self.pressure_shape),
            np.zeros(self.body_values.shape),
            0.0,
        )
