"""The bellows in CalculiX: writes an input deck, runs ccx, reads the tip's displacement from its .dat file.

Usage: python calculix_bellows.py MESH.npz '{"element": "C3D20R", "first": 0.1}'; prints a line of JSON.
Steps are CalculiX's own automatic ones. It has no displacement-pressure element: the silicone is nearly incompressible.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np

begin = time.perf_counter()
data, options = np.load(sys.argv[1]), json.loads(sys.argv[2])
points, cells = data["points"], data["cells"]
# Nodes of CalculiX's cells in basix order, corners of its faces, usual element, by nodes per cell in basix.
KINDS: dict[int, tuple[list[int], list[tuple[int, ...]], str]] = {
    10: ([0, 1, 2, 3, 9, 6, 8, 7, 5, 4], [(1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)], "C3D10"),
    27: (
        [0, 1, 3, 2, 4, 5, 7, 6, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 15, 14],
        [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)],
        "C3D20R",
    ),
    6: ([0, 1, 2, 5, 3, 4], [(1, 2), (2, 3), (3, 1)], "CAX6"),
    9: ([0, 1, 3, 2, 4, 6, 7, 5], [(1, 2), (2, 3), (3, 4), (4, 1)], "CAX8R"),
}
order, faces, usual = KINDS[cells.shape[1]]
element = options.get("element", usual)
cells = cells[:, order] + 1
used = np.unique(cells)
c1, c2, c3 = data["yeoh_mpa"]
bulk = options.get("kappa_over_mu", 1000.0) * 2.0 * c1
young, poisson = data["ring_mpa_nu"]


def numbers(nodes: Iterable[int]) -> str:
    """Node numbers, ten a line."""
    texts = list(map(str, nodes))
    return ",\n".join(",".join(texts[i : i + 10]) for i in range(0, len(texts), 10))


deck = ["*NODE, NSET=ALL"]
deck += [f"{n},{','.join(f'{v:.12g}' for v in points[n - 1])}" for n in used]
for region, name in ((1, "SILICONE"), (2, "RING")):
    deck.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
    for k in np.flatnonzero(data["regions"] == region):
        deck.append(f"{k + 1},{numbers(cells[k])}")
clamped = np.intersect1d(np.unique(data["clamped_facets"]) + 1, used)
deck += ["*NSET, NSET=CLAMPED", numbers(clamped), "*NSET, NSET=TIP", numbers(data["tip_nodes"] + 1)]
deck += ["*MATERIAL, NAME=SILICONE", "*HYPERELASTIC, YEOH", f"{c1},{c2},{c3},{2.0 / bulk},0,0"]
deck += ["*MATERIAL, NAME=RING", "*ELASTIC", f"{young},{poisson}"]
deck += ["*SOLID SECTION, ELSET=SILICONE, MATERIAL=SILICONE", "*SOLID SECTION, ELSET=RING, MATERIAL=RING"]
deck += ["*BOUNDARY", f"CLAMPED,1,{points.shape[1]}"]
if len(data["axis_facets"]):
    axis = np.intersect1d(np.unique(data["axis_facets"]) + 1, used)
    deck += ["*NSET, NSET=AXIS", numbers(axis), "*BOUNDARY", "AXIS,1,1"]
deck += [f"*STEP, NLGEOM, INC={options.get('increments', 500)}", "*STATIC"]
deck += [f"{options.get('first', 0.1)},1.,1e-6,{options.get('largest', 1.0)}", "*DLOAD"]
for facet, cell in zip(data["cavity_facets"], data["cavity_cells"], strict=True):
    wanted = set(facet[: len(faces[0])] + 1)
    face = next(f for f, c in enumerate(faces, start=1) if {cells[cell, i - 1] for i in c} == wanted)
    deck.append(f"{cell + 1},P{face},{data['pressure_mpa']}")
deck += ["*NODE PRINT, NSET=TIP", "U", "*END STEP", ""]

with tempfile.TemporaryDirectory() as folder:
    Path(folder, "job.inp").write_text("\n".join(deck), encoding="ascii")
    setup = time.perf_counter() - begin
    threads = str(options.get("threads", 2))
    run = subprocess.run(
        ["ccx", "-i", "job"],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    found: dict[int, float] = {}
    at = 0.0
    for line in Path(folder, "job.dat").read_text(encoding="ascii").splitlines():
        fields = line.split()
        if "displacements" in line:
            at, found = float(fields[-1]), {}
        elif len(fields) == 4:
            found[int(fields[0])] = float(fields[points.shape[1]])
    log = Path(folder, "job.sta")
    increments = len(log.read_text(encoding="ascii").splitlines()) - 2 if log.exists() else 0
errors = [line for line in run.stdout.splitlines() if "ERROR" in line]
tip = float(data["tip_weights"] @ [found.get(int(n) + 1, np.nan) for n in data["tip_nodes"]])
print(
    json.dumps(
        {
            "tip_mm": tip,
            "pressure_mpa": at * float(data["pressure_mpa"]),
            "dofs": int(points.shape[1] * (len(used) - len(clamped))),
            "iterations": run.stdout.count("iteration "),
            "increments": increments,
            "setup_s": setup,
            "total_s": time.perf_counter() - begin,
            "peak_mb": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024,
            "reason": "" if at > 0.999 else (errors[0].strip() if errors else run.stdout[-200:]),
        }
    )
)
