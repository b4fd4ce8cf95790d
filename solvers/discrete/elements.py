"""Pairs of displacement and pressure spaces, and the quadrature that suits their cells.

Names: the letter is the kind of cell (P: triangles and tetrahedra, Q: quadrilaterals and hexahedra), the numbers are
the degrees of displacement and pressure.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from solvers import compat
from solvers.errors import SolverError


@dataclass(frozen=True)
class Element:
    """A displacement-pressure pair.

    Attributes
    ----------
    name
        For reports.
    displacement_degree
        Continuous polynomials of this degree.
    pressure
        ``continuous``: linear from corner to corner; ``linear``: linear in each reference cell, with jumps;
        ``constant`` in each cell.
    pressure_degree
        Of a richer pair, of which ``continuous`` and ``linear`` only say if there are jumps.
    """

    name: str
    displacement_degree: int
    pressure: Literal["continuous", "linear", "constant"]
    pressure_degree: int = 1

    def spaces(self, cell: Any, fields: int = 1) -> Any:
        """The mixed UFL element on a UFL cell, with so many pressures.

        Raises
        ------
        SolverError
            For a pair with too many pressures: they oscillate from cell to cell.
        """
        name = compat.cell_name(cell)
        box = name in ("quadrilateral", "hexahedron")
        enough = self.displacement_degree > 1 and (box or self.pressure != "linear")
        if not enough and self.pressure != "constant":
            raise SolverError(
                f"{self.name}: displacements of degree {self.displacement_degree} with {self.pressure} pressures "
                f"are unstable on a {name}: take one of {P2_P1.name}, {P2_P0.name}, {Q2_P1.name}"
            )
        family, degree = {
            "continuous": ("Lagrange", self.pressure_degree),
            "linear": ("DPC" if box else "DG", self.pressure_degree),
            "constant": ("DG", 0),
        }[self.pressure]
        displacement = compat.element("Lagrange", cell, self.displacement_degree, (compat.dimension(cell),))
        return compat.mixed_element([displacement, *[compat.element(family, cell, degree)] * fields])


P2_P1 = Element("P2/P1", 2, "continuous")
# What ANSYS calls SOLID187 with a constant pressure.
P2_P0 = Element("P2/P0", 2, "constant")
Q2_P1 = Element("Q2/P1 discontinuous", 2, "linear")
# Linear displacements on straight cells make det F constant in each, so that one pressure per cell with a finite bulk
# modulus is the same as no pressure unknown at all: the plain displacement element. It locks; kept as the control.
P1_P0 = Element("P1 plain", 1, "constant")

# Degree 4 integrates the split energy on quadratic tetrahedra to below the discretisation error; on meridians
# the factor r and few cells make one more degree free. Degree 5 on hexahedra is Gauss' rule of 3 x 3 x 3 points.
# Measured in docs/decisions.md.
QUADRATURE_DEGREE = {"triangle": 5, "tetrahedron": 4, "quadrilateral": 5, "hexahedron": 5}

# Pairs with room for what the usual ones leave out, on meridians, and their quadrature: see solvers.estimate.enriched.
ENRICHED = {
    "triangle": (Element("P4/P3", 4, "continuous", 3), 9),
    "quadrilateral": (Element("Q4/P3 discontinuous", 4, "linear", 3), 9),
}


def usual_element(cell_name: str) -> Element:
    """The element of choice on a kind of cell."""
    return Q2_P1 if cell_name in ("quadrilateral", "hexahedron") else P2_P1
