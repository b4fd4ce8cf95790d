"""The bellows in FElupe: hexahedra or, axisymmetric, quadrilaterals (its pressure load knows no tetrahedra).

Usage: python felupe_bellows.py MESH.npz '{"formulation": "mean", "first": 0.1}'; prints a line of JSON.
``mean``: nearly incompressible with one pressure per cell, eliminated (mean dilatation); ``mixed``: displacement,
pressure and volume ratio, the latter two linear and discontinuous.
"""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

options = json.loads(sys.argv[2])
os.environ["MKL_NUM_THREADS"] = str(options.get("threads", 2))
os.environ["FELUPE_VERBOSE"] = "false"

import felupe as fem  # noqa: E402
from felupe.math import cdya_ik, cdya_il, ddot, det, dya, identity, inv, transpose  # noqa: E402
from pypardiso import spsolve  # noqa: E402

begin = time.perf_counter()
data = np.load(sys.argv[1])
flat = data["points"].shape[1] == 2
c1, c2, c3 = map(float, data["yeoh_mpa"])
mu = 2.0 * c1
bulk = options.get("kappa_over_mu", 5000.0) * mu


# --- the law: FElupe has Yeoh by automatic differentiation only, several times slower --------------------------
def parts(x: list[Any]) -> tuple[Any, ...]:
    """F, its inverse transposed, J^(-2/3), I1, W' and W'' of the isochoric Yeoh law."""
    F = x[0]
    J = det(F)
    scale = J ** (-2 / 3)
    I1 = ddot(F, F)
    e = scale * I1 - 3
    return F, transpose(inv(F, J)), scale, I1, c1 + 2 * c2 * e + 3 * c3 * e**2, 2 * c2 + 6 * c3 * e


def stress(x: list[Any], **kwargs: Any) -> list[Any]:
    """First Piola-Kirchhoff stress."""
    F, G, scale, I1, W1, _ = parts(x)
    return [2 * W1 * scale * (F - I1 / 3 * G), x[-1]]


def elasticity(x: list[Any], **kwargs: Any) -> list[Any]:
    """Its derivative."""
    F, G, scale, I1, W1, W11 = parts(x)
    B = F - I1 / 3 * G
    eye = identity(F)
    FG = dya(F, G)
    GF = dya(G, F)
    tangent = cdya_ik(eye, eye) - 2 / 3 * (FG + GF) + I1 / 3 * cdya_il(G, G) + 2 / 9 * I1 * dya(G, G)
    return [2 * W1 * scale * tangent + 4 * W11 * scale**2 * dya(B, B)]


# --- mesh: basix order to VTK's -----------------------------------------------------------------------------------
if flat:
    order, cell_type = [0, 1, 3, 2, 4, 6, 7, 5, 8], "quad9"
    region_of, boundary_of = fem.RegionBiQuadraticQuad, fem.RegionBiQuadraticQuadBoundary
else:
    order = [0, 1, 3, 2, 4, 5, 7, 6, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 15, 14, 22, 23, 21, 24, 20, 25, 26]
    cell_type = "hexahedron27"
    region_of, boundary_of = fem.RegionTriQuadraticHexahedron, fem.RegionTriQuadraticHexahedronBoundary
mesh = fem.Mesh(data["points"][:, ::-1] if flat else data["points"], data["cells"][:, order], cell_type)
if flat:  # FElupe's axis of revolution is its first coordinate: (z, r) is turned, so are the cells
    mesh.update(cells=mesh.cells[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]])
soft, stiff = (fem.Mesh(mesh.points, mesh.cells[data["regions"] == k], cell_type) for k in (1, 2))
Field = fem.FieldAxisymmetric if flat else fem.Field
dim = 2 if flat else 3
mixed = options.get("formulation", "mean") == "mixed"
everything = region_of(mesh)
field = fem.FieldContainer([Field(everything, dim=dim)])
umat = fem.Material(stress, elasticity)
silicone = region_of(soft)
rings = fem.FieldContainer([Field(region_of(stiff), dim=dim)])
young, poisson = map(float, data["ring_mpa_nu"])
ring = fem.SolidBody(fem.NeoHooke(mu=young / (2 + 2 * poisson), bulk=young / (3 * (1 - 2 * poisson))), rings)
if mixed:
    fields = fem.FieldsMixed(silicone, n=3, axisymmetric=flat)
    body = fem.SolidBody(fem.NearlyIncompressible(umat, bulk=bulk), fields)
    field = fem.FieldContainer([field[0], fields[1], fields[2]])
else:
    body = fem.SolidBodyNearlyIncompressible(umat, fem.FieldContainer([Field(silicone, dim=dim)]), bulk=bulk)
mask = np.zeros(len(mesh.points), dtype=bool)
mask[np.unique(data["cavity_facets"])] = True
wall = boundary_of(soft, mask=mask, **({"ensure_3d": True} if flat else {}))
load = fem.SolidBodyPressure(fem.FieldContainer([Field(wall, dim=dim)]))
for item in (body.field, ring.field, load.field):
    item.link(field)
clamped = np.zeros(len(mesh.points), dtype=bool)
clamped[np.unique(data["clamped_facets"])] = True
held = {"clamped": fem.Boundary(field[0], mask=clamped)}
if flat:
    axis = np.zeros(len(mesh.points), dtype=bool)
    axis[np.unique(data["axis_facets"])] = True
    held["axis"] = fem.Boundary(field[0], mask=axis, skip=(True, False))
dof0, dof1 = fem.dof.partition(field, held)
ext0 = fem.dof.apply(field, held, dof0)

# --- steps ----------------------------------------------------------------------------------------------------------
target, at, step, iterations, rejected, reason = float(data["pressure_mpa"]), 0.0, options.get("first", 0.1), 0, 0, ""
items = [body, ring, load]
setup = time.perf_counter() - begin
while at < 1.0 and not reason:
    state = None if mixed else body.checkpoint()
    load.update(target * min(1.0, at + step))
    try:
        with np.errstate(all="ignore"):
            done = fem.newtonraphson(
                items=items, x0=field, dof0=dof0, dof1=dof1, ext0=ext0, solver=spsolve, tol=1e-6, maxiter=12, verbose=0
            )
        field, iterations = done.x, iterations + done.iterations
        at, step = min(1.0, at + step), step * (1.5 if done.iterations <= 7 else 1.0)
    except ValueError:
        iterations, rejected, step = iterations + 12, rejected + 1, 0.5 * step
        if state is not None:
            body.restore(state)
        reason = "step size" if step < 1e-3 else ""
axial = field[0].values[:, 0 if flat else 2]
# (getrusage would count the process that started this one)
status = Path("/proc/self/status").read_text(encoding="ascii")
peak_mb = int(status.split("VmHWM:")[1].split()[0]) / 1024
print(
    json.dumps(
        {
            "tip_mm": float(data["tip_weights"] @ axial[data["tip_nodes"]]),
            "pressure_mpa": at * target,
            "dofs": len(dof1),
            "iterations": iterations,
            "rejected": rejected,
            "setup_s": setup,
            "total_s": time.perf_counter() - begin,
            "peak_mb": peak_mb,
            "reason": reason,
        }
    )
)
