"""The one scalar load of a problem, and the volume-like functional that does work against it.

A load factor P (MPa) acts through a functional g (mm^3) with the potential ``-P g(u)``:

=============  ===========================================  =================================================
load           traction on the loaded surface               g
=============  ===========================================  =================================================
cavity         ``-P cof F N``, a pressure from inside       enclosed volume
suction        ``+P cof F N``, a vacuum inside              minus the enclosed volume
external       ``-P cof F N``, a pressure from outside      minus the enclosed volume
dead           ``+P N``, a tension that keeps direction     ``int u . N dA``, the gain of volume to first order
dead_pressure  ``-P N``, a push that keeps direction        ``-int u . N dA``
dead_shear     ``+P e``, e the second direction (y)         ``int u . e dA``
=============  ===========================================  =================================================

With N out of the solid a pressure from inside and from outside have the same form, ``-1/2 int (x, y, 0) . cof F N dA``;
it is the volume when the surface is closed by planes z = const, x = 0 or y = 0 that are not meshed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import ufl

from solvers.discrete.kinematics import Kinematics, cofactor

LoadKind = Literal["cavity", "suction", "external", "dead", "dead_pressure", "dead_shear"]
# Sign of the traction along the normal, or along the second direction, for loads that keep their direction.
DEAD = {"dead": 1.0, "dead_pressure": -1.0, "dead_shear": 1.0}


@dataclass(frozen=True)
class LoadForms:
    """UFL forms of a load.

    Attributes
    ----------
    volume, volume_gradient
        g and its derivative.
    traction
        Force of a unit load written without the potential; equal to ``volume_gradient`` on all directions that
        respect the constraints when the load is conservative.
    """

    volume: Any
    volume_gradient: Any
    traction: Any


def load_forms(kind: LoadKind, space: Any, state: Any, kin: Kinematics, measure: Any) -> LoadForms:
    """Forms of a load on the surface of ``measure``; see the module's heading.

    Parameters
    ----------
    kind
        See the module's heading.
    space, state
        Mixed space and the state (u, p) in it.
    kin
        Kinematics of the mesh.
    measure
        Facet measure of the loaded surface, quadrature degree included.

    Returns
    -------
    LoadForms
    """
    u = ufl.split(state)[0]
    v = kin.three(ufl.TestFunctions(space)[0])
    if kind in DEAD:
        along = ufl.as_vector([0.0, 1.0, 0.0]) if kind == "dead_shear" else kin.normal
        volume = DEAD[kind] * ufl.inner(kin.three(u), along) * kin.measure * measure
        traction = DEAD[kind] * ufl.inner(along, v) * kin.measure * measure
    else:
        area = cofactor(ufl.Identity(3) + kin.gradient(u)) * kin.normal
        volume = -0.5 * ufl.inner(kin.transverse_position(u), area) * kin.measure * measure
        traction = -ufl.inner(area, v) * kin.measure * measure
        if kind == "suction":
            volume, traction = -volume, -traction
    return LoadForms(volume, ufl.derivative(volume, state, ufl.TestFunction(space)), traction)


def load_tangent(
    internal: Any, load: LoadForms, kind: LoadKind, conservative: bool, space: Any, state: Any, factor: Any
) -> Any:
    """Tangent of a problem: that of the internal force less that of the load times its factor P.

    Symmetric if ``conservative``; a dead load adds nothing.
    """
    if kind in DEAD:
        return internal
    force = load.volume_gradient if conservative else load.traction
    return internal - factor * ufl.derivative(force, state, ufl.TrialFunction(space))
