"""A body that is solved on a part of it between planes of symmetry: states and modes of the whole, and their proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshes.errors import MeshError
from meshes.solid import IntArray, SolidMesh
from solvers.bodies.rigid import MOTIONS
from solvers.equilibrium.newton import relative_residual
from solvers.problem import Problem
from solvers.stability.parity import ParityClass, Plane, symmetric_class
from solvers.state import State

# Nodes that are farther from each other's mirror images than this share of the body are not.
SAME_PLACE = 1e-9
# A state is its own mirror image at 45 degrees up to this share of its largest displacement; in doubt more is counted.
ALIKE = 1e-6


@dataclass(frozen=True, eq=False)
class Mirrored:
    """A whole body as mirror images of a part.

    Attributes
    ----------
    whole
        The body's mesh.
    planes
        Planes of symmetry through the origin, perpendicular to coordinates.
    node, is_mirrored
        The part's node that each of the body's is an image of, shape (nodes,), and in which of the planes it is
        mirrored, shape (nodes, planes).
    cell, corner
        The same of cells, shape (cells,), and of their corners, shape (cells, corners).
    """

    whole: SolidMesh
    planes: tuple[Plane, ...]
    node: IntArray
    is_mirrored: NDArray[np.bool_]
    cell: IntArray
    corner: IntArray

    @property
    def parts(self) -> int:
        """Number of images."""
        return 1 << len(self.planes)

    def state(self, of_part: State) -> State:
        """The symmetric state of the whole."""
        return self.of_class(of_part, symmetric_class(self.planes).name)

    def of_class(self, of_part: State, name: str) -> State:
        """A field of the whole from the part's field of a parity class, whose motions the bodies of the part have."""
        parity = ParityClass(self.planes, name)
        signs = np.array([1.0 if letter == "S" else -1.0 for letter in name])
        sign = np.where(self.is_mirrored, signs, 1.0).prod(axis=1)
        displacement = of_part.displacement_mm[self.node] * sign[:, None]
        for k, plane in enumerate(self.planes):
            displacement[self.is_mirrored[:, k], plane.normal] *= -1.0
        centre = self.whole.cells[:, -1]
        pressure = of_part.pressure_mpa[self.cell[:, None], self.corner] * sign[centre, None]
        bodies = np.zeros((len(of_part.bodies_mm), MOTIONS if len(of_part.bodies_mm) else 0))
        if len(bodies):
            bodies[:, list(parity.motions)] = of_part.bodies_mm[:, : len(parity.motions)]
        return State(displacement, pressure, bodies, of_part.load_mpa)


def mirror(part: SolidMesh, whole: SolidMesh, planes: Sequence[Plane]) -> Mirrored:
    """A body of hexahedra as mirror images of a part of it, in which coordinates along the normals are not negative.

    Raises
    ------
    MeshError
        If it is something else.
    """
    axes = [plane.normal for plane in planes]
    size = float(np.ptp(whole.points, axis=0).max())
    is_mirrored = whole.points[:, axes] < -SAME_PLACE * size
    folded = whole.points.copy()
    folded[:, axes] = np.abs(folded[:, axes])
    away, node = cKDTree(part.points).query(folded)
    number = np.full(len(part.points), -1, dtype=np.int64)
    number[part.cells[:, -1]] = np.arange(len(part.cells))  # the last node is in the middle of its cell
    cell = number[node[whole.cells[:, -1]]]
    if away.max() > SAME_PLACE * size or cell.min() < 0 or len(whole.cells) != len(part.cells) << len(axes):
        raise MeshError("the body's mesh is not made of mirror images of the part's")
    corners = part.cell.corners
    ours, theirs = node[whole.cells[:, :corners]], part.cells[cell, :corners]
    corner = np.empty_like(ours)
    np.put_along_axis(corner, np.argsort(ours, axis=1), np.argsort(theirs, axis=1), axis=1)
    if (np.take_along_axis(theirs, corner, axis=1) != ours).any():
        raise MeshError("cells of the body's mesh are not mirror images of the part's")
    return Mirrored(whole, tuple(planes), node, is_mirrored, cell, corner)


class Diagonal:
    """Whether states of a quarter are their own mirror images in the plane x = y; the mesh must be."""

    def __init__(self, part: SolidMesh) -> None:
        away, self._other = cKDTree(part.points).query(part.points[:, [1, 0, 2]])
        self._fits = away.max() <= SAME_PLACE * float(np.ptp(part.points, axis=0).max())

    def is_alike(self, state: State) -> bool:
        """True if a state is."""
        u = state.displacement_mm
        return bool(self._fits and np.abs(u[self._other][:, [1, 0, 2]] - u).max() <= ALIKE * np.abs(u).max())


@dataclass(frozen=True)
class Proof:
    """The whole body's problem, which proves states of a part by one assembly of its residual.

    Attributes
    ----------
    mirrored
        The body as images of the part.
    problem
        Of the whole body.
    """

    mirrored: Mirrored
    problem: Problem

    @property
    def unknowns(self) -> int:
        """Those of the whole body."""
        return int(self.problem.index_map.size_global) + self.problem.extra

    def residual(self, of_part: State) -> float:
        """Residual of the whole body in the mirrored state relative to its load; every rank calls."""
        self.problem.set_state(self.mirrored.state(of_part))
        return relative_residual(self.problem)
