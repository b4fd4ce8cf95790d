"""The bellows as the dolfinx tutorials do it: NewtonSolver, LU, fixed pressure steps, P2/P1 elements.

Usage: [mpirun -n 2] python -m studies.peers.dolfinx_tutorial MESH.npz '{"steps": 20}'; rank 0 prints a line of JSON.
Run it once with the reference BLAS in LD_LIBRARY_PATH and once without: the distribution's default is the slow one.
The mesh comes in by this program's reader, in place of the tutorials' gmshio.
"""

import json
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.nls.petsc import NewtonSolver
from mpi4py import MPI
from petsc4py import PETSc

from solvers import compat
from solvers.discrete.domain import create_domain

comm = MPI.COMM_WORLD
begin = time.perf_counter()
data, options = np.load(sys.argv[1]), json.loads(sys.argv[2])
gdim = data["points"].shape[1]
flat = gdim == 2

# --- mesh ----------------------------------------------------------------------------------------------
named = {"cavity": 1, "clamped": 2, "axis": 3, "plane_x": 4, "plane_y": 5}
corners = 4 if data["cells"].shape[1] == 27 else gdim  # of a facet
facets = [data[f"{name}_facets"][:, :corners] for name in named if len(data[f"{name}_facets"])]
tags = np.repeat([named[n] for n in named if len(data[f"{n}_facets"])], [len(f) for f in facets])
arrays = SimpleNamespace(
    points=data["points"],
    cells=data["cells"],
    regions=data["regions"],
    facets=np.sort(np.vstack(facets), axis=1),
    facet_tags=tags,
    facet_bodies=np.full(len(tags), -1),
)
domain = create_domain(comm, arrays if comm.rank == 0 else None)
mesh = domain.mesh
metadata = {"quadrature_degree": 4}  # the tutorials' value; UFL's own estimate is 27
dx = ufl.Measure("dx", mesh, subdomain_data=domain.cell_tags, metadata=metadata)
ds = ufl.Measure("ds", mesh, subdomain_data=domain.facet_tags, metadata=metadata)

# --- problem --------------------------------------------------------------------------------------------
cell = mesh.ufl_cell()
taylor_hood = compat.mixed_element([compat.element("Lagrange", cell, 2, (gdim,)), compat.element("Lagrange", cell, 1)])
W = compat.function_space(mesh, taylor_hood)
w = fem.Function(W)
u, p = ufl.split(w)
test = ufl.TestFunction(W)
v = ufl.split(test)[0]
x = ufl.SpatialCoordinate(mesh)
g = ufl.grad(u)
if flat:
    F = ufl.as_matrix([[1 + g[0, 0], g[0, 1], 0], [g[1, 0], 1 + g[1, 1], 0], [0, 0, 1 + u[0] / x[0]]])
    around, normal = 2 * np.pi * x[0], ufl.as_vector([*ufl.FacetNormal(mesh), 0])
    motion = ufl.as_vector([v[0], v[1], 0])
else:
    F, around, normal, motion = ufl.Identity(3) + g, 1, ufl.FacetNormal(mesh), v
J = ufl.det(F)
I1 = J ** (-2 / 3) * ufl.tr(F.T * F)
c1, c2, c3 = map(float, data["yeoh_mpa"])
young, poisson = map(float, data["ring_mpa_nu"])
mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
E = (F.T * F - ufl.Identity(3)) / 2
energy = around * (c1 * (I1 - 3) + c2 * (I1 - 3) ** 2 + c3 * (I1 - 3) ** 3 + p * (J - 1)) * dx(1)
# the small term gives the pressure inside the rings, which none uses, the value 0
energy += around * (mu * ufl.inner(E, E) + lam / 2 * ufl.tr(E) ** 2 - 1e-6 * p**2) * dx(2)
pressure = fem.Constant(mesh, PETSc.ScalarType(0.0))
cofactor = J * ufl.inv(F).T
residual = ufl.derivative(energy, w, test) + pressure * around * ufl.dot(cofactor * normal, motion) * ds(1)


def held(tag: int, space: Any) -> Any:
    """Degrees of freedom of a space on a surface."""
    whole = space.collapse()[0]
    there = domain.facet_tags.find(tag)
    zero = fem.Function(whole)
    return fem.dirichletbc(zero, fem.locate_dofs_topological((space, whole), gdim - 1, there), space)


bcs = [held(2, W.sub(0))]
for tag, component in ((3, 0), (4, 0), (5, 1)):
    if tag in tags:
        bcs.append(held(tag, W.sub(0).sub(component)))
solver = NewtonSolver(comm, compat.newton_problem(residual, w, bcs))
solver.convergence_criterion = "incremental"
solver.rtol = 1e-6
solver.max_it = 25
krylov = solver.krylov_solver
chosen = PETSc.Options()
prefix = krylov.getOptionsPrefix()
chosen[f"{prefix}ksp_type"] = "preonly"
chosen[f"{prefix}pc_type"] = "lu"
chosen[f"{prefix}pc_factor_mat_solver_type"] = "mumps"
krylov.setFromOptions()

# --- steps ------------------------------------------------------------------------------------------------
setup = time.perf_counter() - begin
if options.get("compile_only"):
    sys.exit()
target, steps, reached, iterations, reason = float(data["pressure_mpa"]), options.get("steps", 20), 0.0, 0, ""
for k in range(1, steps + 1):
    pressure.value = target * k / steps
    try:
        count, converged = solver.solve(w)
    except RuntimeError as error:
        reason = f"step {k} of {steps}: {str(error).splitlines()[-1]}"
        break
    if not np.isfinite(w.x.norm()):
        reason = f"step {k} of {steps}: not a number"
        break
    iterations, reached = iterations + count, target * k / steps
space = compat.function_space(mesh, ("Lagrange", 2), (gdim,))
motion_now = fem.Function(space)
motion_now.interpolate(w.sub(0).collapse())
table = np.zeros(len(data["points"]))
own = space.dofmap.index_map.size_local
values = motion_now.x.array.reshape(-1, gdim)[:own]
places = space.tabulate_dof_coordinates()[:own, :gdim]  # the tip's nodes are found by place: they are few
for node, weight in zip(data["tip_nodes"], data["tip_weights"], strict=True):
    near = np.flatnonzero(np.linalg.norm(places - data["points"][node], axis=1) < 1e-9)
    table[node] = weight * values[near[0], gdim - 1] if len(near) else 0.0
tip = comm.allreduce(table.sum())
status = Path("/proc/self/status").read_text(encoding="ascii")
peak = comm.allreduce(int(status.split("VmHWM:")[1].split()[0]) / 1024)
if comm.rank == 0:
    print(
        json.dumps(
            {
                "tip_mm": tip,
                "pressure_mpa": reached,
                "dofs": W.dofmap.index_map.size_global * W.dofmap.index_map_bs,
                "iterations": iterations,
                "setup_s": setup,
                "total_s": time.perf_counter() - begin,
                "peak_mb": peak,
                "reason": reason,
            }
        )
    )
