"""What the numbers of a mesh's regions and surfaces stand for in a problem."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import ufl

from solvers.discrete.domain import Domain
from solvers.energy.loads import LoadKind
from solvers.errors import SolverError

# Material numbers of cells; those of further soft materials are greater.
SOFT, STIFF = 1, 2


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
        Held axially, and the force on what holds it is known: `solvers.equilibrium.forces.end_force`.
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


def cell_measures(domain: Domain, degree: int, numbers: Collection[int]) -> dict[int, Any]:
    """Measures of the cells of each material number, of all where there is one, of a quadrature degree."""
    if len(numbers) == 1:
        return {number: ufl.dx(domain=domain.mesh, degree=degree) for number in numbers}
    dx = domain.dx(degree=degree)
    return {number: dx(number) for number in numbers}
