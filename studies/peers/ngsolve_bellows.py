"""The bellows in NGSolve: displacement-pressure elements of any order on tetrahedra or hexahedra; or triangles.

Usage: python ngsolve_bellows.py MESH.npz '{"order": 2, "first": 0.25, "solver": "pardiso"}'; prints a line of JSON.
The load is the potential -P V of the closed cavity, so the tangent is symmetric; steps grow and shrink.
"""

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import netgen.meshing as ng
import numpy as np
from ngsolve import (
    H1,
    BilinearForm,
    CoefficientFunction,
    Cof,
    Det,
    GridFunction,
    Id,
    Mesh,
    Parameter,
    SetNumThreads,
    TaskManager,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    grad,
    specialcf,
    x,
    y,
    z,
)
from ngsolve.solvers import Newton

begin = time.perf_counter()
data, options = np.load(sys.argv[1]), json.loads(sys.argv[2])
SetNumThreads(options.get("threads", 2))
flat = data["points"].shape[1] == 2

# --- mesh: one in 3D is curved by its second-order elements, a plane one by a deformation -----------------
# (Netgen keeps the boundary edges of plane second-order elements straight)
made = ng.Mesh(dim=2 if flat else 3)
corners = 1 + data["cells"][:, : 3 if flat else 4].max()
node = [made.Add(ng.MeshPoint(ng.Pnt(*p, *([0.0] * flat)))) for p in data["points"][: corners if flat else None]]
# Basix nodes in Netgen's order of cells and facets: edges are numbered differently; triangles agree
order = {
    6: [0, 1, 2],
    10: [0, 1, 2, 3, 9, 8, 7, 6, 5, 4],
    27: [0, 1, 5, 4, 2, 3, 7, 6, 8, 16, 10, 12, 13, 19, 14, 15, 9, 11, 18, 17],
}[data["cells"].shape[1]]
facet_order = {6: [0, 1], 10: [0, 1, 2, 3, 4, 5], 27: [0, 1, 3, 2, 4, 7, 5, 6]}[data["cells"].shape[1]]
names = ["cavity", "clamped", "axis", "plane_x", "plane_y"]
for number, name in enumerate(names, start=1):
    made.Add(ng.FaceDescriptor(surfnr=number, domin=1, domout=0, bc=number))
    made.SetBCName(number - 1, name)
for region, cell in zip(data["regions"], data["cells"][:, order], strict=True):
    element = [node[i] for i in cell]
    made.Add(ng.Element2D(int(region), element) if flat else ng.Element3D(int(region), element))
for number, name in enumerate(names, start=1):
    for facet in data[f"{name}_facets"][:, facet_order] if len(data[f"{name}_facets"]) else ():
        element = [node[i] for i in facet]
        made.Add(ng.Element1D(element, index=number) if flat else ng.Element2D(number, element))
made.SetMaterial(1, "silicone")
made.SetMaterial(2, "ring")
mesh = Mesh(made)
if flat:
    points, bend, bubble = data["points"], GridFunction(VectorH1(mesh, order=2)), GridFunction(H1(mesh, order=2))
    middle = {frozenset(c[[i, j]]): c[k] for c in data["cells"] for k, i, j in ((3, 1, 2), (4, 0, 2), (5, 0, 1))}
    bubble.vec[corners] = 1.0  # the first edge's
    first, second = (points[v.nr] for v in next(iter(mesh.edges)).vertices)
    height = bubble(mesh(*(0.5 * (first + second))))
    for edge in mesh.edges:
        a, b = (v.nr for v in edge.vertices)
        offset = points[middle[frozenset((a, b))]] - 0.5 * (points[a] + points[b])
        for i in range(2):
            bend.components[i].vec[corners + edge.nr] = offset[i] / height
    mesh.SetDeformation(bend)

# --- problem ----------------------------------------------------------------------------------------
k = options.get("order", 2)
held = {"dirichletx": "clamped|axis|plane_x"} | ({} if flat else {"dirichlety": "clamped|plane_y"})
V = VectorH1(mesh, order=k, dirichlet="clamped", **held)
Q = H1(mesh, order=k - 1, definedon="silicone")
X = V * Q
u, p = X.TrialFunction()
c1, c2, c3 = map(float, data["yeoh_mpa"])
young, poisson = map(float, data["ring_mpa_nu"])
mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
pressure = Parameter(0.0)


def deformation(g: Any) -> Any:
    """F; on a meridian with the hoop stretch."""
    if not flat:
        return g + Id(3)
    return CoefficientFunction((1 + g[0, 0], g[0, 1], 0, g[1, 0], 1 + g[1, 1], 0, 0, 0, 1 + u[0] / x), dims=(3, 3))


F = deformation(grad(u))
J, I1 = Det(F), Trace(F.trans * F)
e = J ** (-2 / 3) * I1 - 3
E = 0.5 * (F.trans * F - Id(3))
around = 2 * math.pi * x if flat else 1.0
a = BilinearForm(X, symmetric=True, condense=k > 2)
a += Variation(around * (c1 * e + c2 * e**2 + c3 * e**3 + p * (J - 1)) * dx("silicone")).Compile()
a += Variation(around * (mu * Trace(E * E) + 0.5 * lam * Trace(E) ** 2) * dx("ring")).Compile()
n = specialcf.normal(2 if flat else 3)  # out of the silicone, into the cavity
if flat:  # V = -1/2 of the integral of r n_r da over the wall, r da = r^2 ds
    g = grad(u).Trace()
    # deformed normal times length: the tangent (-n_y, n_x) deformed and turned back
    tangent = CoefficientFunction((-n[1], n[0]))
    drawn_z = (tangent + g * tangent)[1]
    a += Variation(pressure * math.pi * (x + u[0]) ** 2 * drawn_z * ds("cavity")).Compile()
else:
    place = CoefficientFunction((x, y, z)) + u
    a += Variation(pressure / 3 * (place * (Cof(grad(u).Trace() + Id(3)) * n)) * ds("cavity")).Compile()
state = GridFunction(X)

# --- steps --------------------------------------------------------------------------------------------
target, at, step, iterations, rejected = float(data["pressure_mpa"]), 0.0, options.get("first", 0.25), 0, 0
reason, kept, change, last = "", state.vec.CreateVector(), state.vec.CreateVector(), 0.0
change[:] = 0.0
setup = time.perf_counter() - begin
with TaskManager():
    while at < 1.0 - 1e-9 and not reason:
        kept.data = state.vec
        step = min(step, 1.0 - at)
        pressure.Set(target * (at + step))
        if options.get("predict", True) and last:
            state.vec.data += step / last * change
        try:
            failed, count = Newton(
                a, state, maxit=12, maxerr=1e-8, inverse=options.get("solver", "pardiso"), printing=False
            )
        except Exception as error:  # a factorisation that failed
            failed, count, reason = 1, 0, str(error)
        iterations += count + 1
        if failed or not np.isfinite(state.vec.Norm()):
            state.vec.data, step, rejected = kept, 0.5 * step, rejected + 1
            reason = "step size" if step < 1e-3 else ""
        else:
            change.data = state.vec - kept
            at, last, step = at + step, step, step * (1.5 if count <= 6 else 1.0)
axial = state.components[0].components[1 if flat else 2].vec.FV().NumPy()  # corner nodes come first
tip = float(data["tip_weights"] @ axial[data["tip_nodes"]])
# (getrusage would count the process that started this one)
status = Path("/proc/self/status").read_text(encoding="ascii")
peak_mb = int(status.split("VmHWM:")[1].split()[0]) / 1024
print(
    json.dumps(
        {
            "tip_mm": tip,
            "pressure_mpa": at * target,
            "dofs": int(sum(X.FreeDofs(a.condense))),
            "iterations": iterations,
            "rejected": rejected,
            "setup_s": setup,
            "total_s": time.perf_counter() - begin,
            "peak_mb": peak_mb,
            "reason": reason,
        }
    )
)
