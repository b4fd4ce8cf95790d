"""Deformation of bodies in (x, y, z) and of meridians in (r, z), brought to one three-dimensional form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import ufl


@dataclass(frozen=True)
class Kinematics:
    """How plane and solid meshes give 3 x 3 tensors and volume measures.

    Components are (x, y, z) in 3D and (r, z, theta) on a meridian.

    Attributes
    ----------
    axisymmetric
        True for a meridian.
    position
        UFL spatial coordinate, mm.
    measure
        Factor on dx and ds: 1 in 3D, 2 pi r on a meridian (mm).
    normal
        Outward reference normal with three components.
    frame
        Directions of the displacement's components as columns of a 3 x 3 tensor; None for those of the coordinates.
    """

    axisymmetric: bool
    position: Any
    measure: Any
    normal: Any
    frame: Any = None

    def gradient(self, u: Any) -> Any:
        """``grad u`` as 3 x 3; on a meridian with the hoop component u_r / r.

        Quadrature points never lie on the axis, where u_r / r would be 0/0.
        """
        if not self.axisymmetric:
            return ufl.grad(u) if self.frame is None else self.frame * ufl.grad(u)
        g = ufl.grad(u)
        hoop = u[0] / self.position[0]
        return ufl.as_matrix([[g[0, 0], g[0, 1], 0.0], [g[1, 0], g[1, 1], 0.0], [0.0, 0.0, hoop]])

    def transverse_position(self, u: Any) -> Any:
        """Deformed position without its axial part: (x, y, 0), or (r, 0, 0) on a meridian."""
        x = self.position + (u if self.frame is None else self.frame * u)
        if self.axisymmetric:
            return ufl.as_vector([x[0], 0.0, 0.0])
        return ufl.as_vector([x[0], x[1], 0.0])

    def three(self, v: Any) -> Any:
        """A displacement as a vector of three components."""
        if self.axisymmetric:
            return ufl.as_vector([v[0], v[1], 0.0])
        return v if self.frame is None else self.frame * v


def kinematics(mesh: Any, axisymmetric: bool, frame: Any = None) -> Kinematics:
    """Kinematics of a mesh; ``axisymmetric`` meshes have coordinates (r, z), and no ``frame`` of their own."""
    x = ufl.SpatialCoordinate(mesh)
    n = ufl.FacetNormal(mesh)
    if axisymmetric:
        return Kinematics(True, x, 2.0 * ufl.pi * x[0], ufl.as_vector([n[0], n[1], 0.0]))
    return Kinematics(False, x, 1.0, n, frame)


def cofactor(f: Any) -> Any:
    """``cof F = J F^-T`` without a division."""
    rows = [[None] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            rows[i][j] = f[a, c] * f[b, d] - f[a, d] * f[b, c]
    return ufl.as_matrix(rows)
