"""Kinds of cells and solvers in scenes of all kinds."""

from __future__ import annotations

import math
from typing import Final, Literal

from pydantic import Field

from studies.scene.sections import Section

# Quadratic displacements with linear pressures, whose orders of convergence are those expected of a bellows.
USUAL_ELEMENTS: Final = ("auto", "hex", "tet")


class Mesh(Section):
    """Kind of cells: hexahedra (quadrilaterals on the meridian), or tetrahedra (triangles) as in the paper.

    ``auto`` takes hexahedra unless the rings are meshed. ``tet-p0`` has one pressure per cell, like ANSYS's SOLID187
    with constant pressure; ``tet-p1`` has linear displacements and no pressure, and locks: the control to compare with.

    ``solver`` is for whole bodies in 3D: ``direct`` factorises; ``iterative`` needs less memory, takes longer and
    counts no unstable modes; ``auto`` goes over to it where the memory does not hold the factors.
    """

    element: Literal["auto", "hex", "tet", "tet-p0", "tet-p1"] = Field(default="auto", description="kind of cells")
    solver: Literal["auto", "direct", "iterative"] = Field(
        default="auto", description="linear algebra of whole bodies in 3D"
    )


class BellowsMesh(Mesh):
    """The same of a bellows, and whether full 3D is solved on a quarter where the body is four images of one.

    The answer is that of the whole body, its count of unstable modes included (`solvers.stability.parity`), at a fifth
    of the cost or less; ``off`` solves the whole body itself.
    """

    symmetry: Literal["auto", "off"] = Field(
        default="auto",
        description="solve full 3D on a part of the body where planes of symmetry allow it, or always on the whole",
    )


def locks(mesh: Mesh) -> bool:
    """True if an element locks: then its meshes agree on a value that is wrong by much more."""
    return mesh.element == "tet-p1"


def element_faults(mesh: Mesh, kappa_over_mu: float) -> list[str]:
    """What is wrong with an element for a material or with a solver for an element."""
    if mesh.solver == "iterative" and mesh.element == "tet-p1":
        return ['mesh.solver = "iterative" with mesh.element = "tet-p1": it is made for quadratic elements']
    if mesh.element != "tet-p1" or math.isfinite(kappa_over_mu):
        return []
    return [
        'mesh.element = "tet-p1" with material.kappa_over_mu = inf: without pressure unknowns the material must be '
        "compressible: set kappa_over_mu, for instance to 1000, or take another element"
    ]
