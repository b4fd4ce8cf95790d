"""Unstable modes of a whole body from a part of it between planes of symmetry: a tangent per class of parities.

Mirrored in a plane, a perturbation of a symmetric state is what it was (S) or the opposite (A). With respect to one
plane or two, perpendicular to x, y or z, the perturbations of the whole body are the sum of two classes or four,
between which its tangent has no coupling. Each class lives on the part, where the tangent is the same but for what is
held:

====  =====================================  ================================================================
      on the plane                           motions of rigid bodies
====  =====================================  ================================================================
S     the component across it                translations along it, and the rotation about its normal
A     the two components along it            the translation across it, and the rotations about axes in it
====  =====================================  ================================================================

So the number of negative eigenvalues of the whole body is the sum of those of the classes, exactly, and an equilibrium
of the part (all S) is one of the whole body. On a quarter of a body that is its own mirror image at 45 degrees too, SA
and AS are each other's mirror images: one of them is counted, twice.

Pressures are those of cells: a continuous one would have to vanish on a plane of class A.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from solvers.assembly.supports import Supports
from solvers.assembly.tangent import Border, bonded_dofs, new_matrix
from solvers.assembly.term import Term
from solvers.bodies.rigid import EVERY_MOTION
from solvers.discrete.domain import FloatArray
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.state import State

AXES = (0, 1, 2)


@dataclass(frozen=True)
class Plane:
    """A plane of symmetry that cuts a mesh.

    Attributes
    ----------
    facets
        Facet numbers of the cut.
    normal
        Component along its normal: 0, 1 or 2 for x, y or z.
    """

    facets: tuple[int, ...]
    normal: int


@dataclass(frozen=True)
class ParityClass:
    """Perturbations of a parity with respect to each of the planes.

    Attributes
    ----------
    planes
        The planes.
    name
        A letter for each: ``SA`` is symmetric in the first and antisymmetric in the second.
    """

    planes: tuple[Plane, ...]
    name: str

    @property
    def held(self) -> tuple[tuple[int, int], ...]:
        """Pairs (facet number, component) that vanish."""
        return tuple(
            (facet, axis)
            for plane, parity in zip(self.planes, self.name, strict=True)
            for facet in plane.facets
            for axis in AXES
            if (axis == plane.normal) == (parity == "S")
        )

    @property
    def motions(self) -> tuple[int, ...]:
        """Those of the six motions of a rigid body in both planes that belong to the class."""
        return tuple(motion for motion in EVERY_MOTION if self._has(motion))

    def _has(self, motion: int) -> bool:
        axis, turns = motion % 3, motion >= 3
        # mirrored, a translation changes its sign across the plane, a rotation about axes in it
        return all(
            (turns == (axis == plane.normal)) == (parity == "S")
            for plane, parity in zip(self.planes, self.name, strict=True)
        )


def symmetric_class(planes: Sequence[Plane]) -> ParityClass:
    """The class of equilibria of a part."""
    return ParityClass(tuple(planes), "S" * len(planes))


def parity_classes(planes: Sequence[Plane]) -> tuple[ParityClass, ...]:
    """All classes, the symmetric one first."""
    names = ("".join(letters) for letters in itertools.product("SA", repeat=len(planes)))
    return tuple(ParityClass(tuple(planes), name) for name in names)


class ParityTangent:
    """The tangent of a part's state in a class, which `select` chooses; for a `solvers.linear.factor.Factor`.

    One pattern, one analysis and, at a state, one assembly serve all classes: bodies have as many unknowns as the class
    of the most motions, and those that another does not have are held; what a class holds is struck out of a copy of
    the solid's tangent, which costs a sixth of assembling it.

    Parameters
    ----------
    problem
        Of the part; its surfaces hold what the symmetric class does.
    classes
        Those that may be selected.

    Raises
    ------
    SolverError
        If the pressure is continuous, the load not conservative, or bodies have other motions than in the symmetric
        class; `take_state` if something may touch.
    """

    conservative = True
    terms: tuple[Term, ...] = ()

    def __init__(self, problem: Problem, classes: Sequence[ParityClass]) -> None:
        if problem.element.pressure == "continuous":
            raise SolverError(
                f"parity classes need pressures of cells, not the continuous ones of {problem.element.name}"
            )
        if not problem.conservative:
            raise SolverError(
                "parity classes need a conservative load: the tangent of this one has no inertia to count"
            )
        symmetric = symmetric_class(classes[0].planes)
        if problem.bonded is not None and tuple(problem.bonded.motions) != symmetric.motions:
            raise SolverError(
                f"parity classes need bodies with the motions {symmetric.motions} of the symmetric one, got "
                f"{tuple(problem.bonded.motions)}"
            )
        self.problem, self.comm, self.timer, self.owned = problem, problem.comm, problem.timer, problem.owned
        bodies = 0 if problem.bonded is None else problem.bonded.count
        self.motions = max((len(c.motions) for c in classes), default=0) if bodies else 0
        self.extra = bodies * self.motions
        self._bonded = bonded_dofs(problem.domain, problem.space, 3, bodies)
        self._border = Border(problem.space, self._bonded, self.motions)
        self._by_others = tuple(pair for pair in problem.surfaces.held if pair not in symmetric.held)
        self._solid: PETSc.Mat | None = None
        self._held_in_all = self._supports_of(())
        self._supports = {c.name: self._supports_of(c.held) for c in classes}
        self.select(classes[0])

    def _supports_of(self, held: tuple[tuple[int, int], ...]) -> Supports:
        surfaces = dataclasses.replace(self.problem.surfaces, held=(*self._by_others, *held))
        return self.problem.unknowns.supports_for(surfaces)

    def select(self, parity: ParityClass) -> None:
        """Go over to a class."""
        self.parity, self.supports = parity, self._supports[parity.name]
        self.expected_negatives = self.problem.unknowns.free_pressures(self.supports)

    def take_state(self, like: PETSc.Mat) -> None:
        """Assemble at the problem's current state what the classes share, in a matrix like that of `new_matrix`."""
        if self.problem.contact is not None:
            raise SolverError("parity classes do not know contact: count on the whole body")
        if self._solid is None:
            self._solid = like.duplicate()
            self._solid.setOption(PETSc.Mat.Option.IGNORE_ZERO_ENTRIES, True)
        self.problem.assemble_held(self._solid, self._held_in_all, [])

    def close(self) -> None:
        """Free the matrix of what the classes share."""
        if self._solid is not None:
            self._solid.destroy()

    @property
    def massless(self) -> NDArray[np.bool_]:
        """Owned dofs that are pressures or held, shape (owned,)."""
        return np.asarray(self.problem.owned_pressure | self.supports.is_constrained[: self.owned])

    def new_matrix(self) -> PETSc.Mat:
        """Empty matrix with the pattern of every class."""
        patterns = [self._border.pattern()] if self.extra else []
        matrix = new_matrix(self.problem.space, self.extra, True, patterns)
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return matrix

    def assemble_tangent(self, matrix: PETSc.Mat) -> None:
        """The class's tangent at the state that was taken, into ``matrix``."""
        assert self._solid is not None
        with self.timer("tangent"):
            held = np.flatnonzero(self.supports.is_constrained[: self.owned]) + self.problem.index_map.local_range[0]
            self._solid.copy(matrix, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            matrix.zeroRowsColumns(held.astype(PETSc.IntType), 1.0)
            if self.extra:
                self._add_border(matrix)
                matrix.assemble()

    def _add_border(self, matrix: PETSc.Mat) -> None:
        """Add the bodies' rows, columns and blocks in the class's motions; what is left of them is held."""
        bonded, bodies = self.problem.bonded, self.problem.bodies
        assert bonded is not None and bodies is not None
        mine, of_class = self.parity.motions, len(self.parity.motions)
        columns = np.zeros((self.owned, self.motions))
        columns[:, :of_class] = bonded.columns(mine)
        columns[self.supports.is_constrained[: self.owned]] = 0.0
        blocks = np.zeros((bonded.count, self.motions, self.motions))
        blocks[:, :of_class, :of_class] = bonded.blocks(mine)
        held = np.ones((bonded.count, self.motions), dtype=bool)
        held[:, :of_class] = dataclasses.replace(bodies, motions=mine).held_motions(axisymmetric=False)
        self._border.add(matrix, columns, blocks, held)


class ParityFactor(Factor):
    """Factor of a part's problem that counts the unstable modes of the whole body.

    One matrix and one factor at a time serve all classes. Bodies have the problem's own motions in equations, and those
    of the tangent, which are as many in each class, in modes.

    Parameters
    ----------
    problem
        Of the part.
    planes
        Its planes of symmetry, the first of which is mirrored into the second if there are two.
    is_alike
        For two planes: true of a state that is its own mirror image at 45 degrees to them.

    Attributes
    ----------
    counts
        Unstable modes of each class that was counted last, once each.
    """

    def __init__(self, problem: Problem, planes: Sequence[Plane], is_alike: Callable[[State], bool]) -> None:
        self._classes = parity_classes(planes)
        self._tangent = ParityTangent(problem, self._classes)
        super().__init__(self._tangent)
        self._is_alike = is_alike
        self.counts: dict[str, int] = {}

    def close(self) -> None:
        """Free the matrices and their factors."""
        super().close()
        self._tangent.close()

    def refresh(self) -> None:
        """Assemble the tangent at the current state and factor the symmetric class; raises as `Factor` does."""
        self._tangent.take_state(self.matrix)
        self._factor(self._classes[0])

    def _factor(self, parity: ParityClass) -> None:
        self._tangent.select(parity)
        super().refresh()

    def solve(self, on_dofs: FloatArray, on_bodies: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Solve in the class that was factored last; bodies have its motions, or those of the tangent."""
        if not self._tangent.extra:
            return super().solve(on_dofs, on_bodies)
        given = on_bodies.reshape(self._tangent.extra // self._tangent.motions, -1)
        padded = np.zeros((len(given), self._tangent.motions))
        padded[:, : given.shape[1]] = given
        dofs, bodies = super().solve(on_dofs, padded.ravel())
        return dofs, bodies.reshape(padded.shape)[:, : given.shape[1]].ravel()

    def unstable_modes(self) -> int | None:
        """Unstable modes of the whole body about the current state, whose symmetric tangent was factored last.

        Then the last class's is.

        Raises
        ------
        StepFailed
            If a factorisation fails.
        """
        found = [(self._classes[0].name, 1, self.excess_negatives)]
        found += [(name, times, self.excess_negatives) for name, times in self._others()]
        self.counts = {name: int(count or 0) for name, _, count in found}
        return sum(times * self.counts[name] for name, times, _ in found)

    def of_classes(self) -> Iterator[tuple[str, Factor]]:
        """The symmetric class, then the others."""
        self.refresh()
        yield self._classes[0].name, self
        for name, _ in self._others():
            yield name, self

    def _others(self) -> Iterator[tuple[str, int]]:
        """The other classes in turn, with how often each counts, factored at the state of the last `refresh`."""
        others = self._classes[1:]
        alike = len(others) == 3 and self._is_alike(self._tangent.problem.get_state())
        for parity in others:
            if alike and parity.name == "AS":
                continue
            self._factor(parity)
            yield parity.name, 2 if alike and parity.name == "SA" else 1
