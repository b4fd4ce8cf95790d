"""What cutting the cells at the seats' edges changes: tips of a scene by refinement and cuts, with what they cost.

``python -m studies.cost.error_model.edges scenes/heung-t1-ri5.toml`` prints the table of docs/decisions.md, "Edges of
the seats".
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from mpi4py import MPI

from meshes.meridian import meridian_mesh
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from studies.models.build import Tip, scene_problem
from studies.report.tables import Table, as_text
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows
from studies.scene.meshes import cell_kind, scene_resolution

# Refinement and cuts.
MESHES: Final = (*((1, cuts) for cuts in range(5)), *((2, cuts) for cuts in range(4)), (4, 0), (4, 2), (4, 4))


def trials(scene: BellowsScene) -> Iterator[tuple[str, ...]]:
    """A line of the table per mesh."""
    for refinement, cuts in MESHES:
        resolution = replace(scene_resolution(scene, refinement), edge_cuts=cuts)
        mesh = meridian_mesh(shape_of(scene), resolution, None, cell_kind(scene))
        start = time.process_time()
        problem = scene_problem(scene, mesh, MPI.COMM_SELF)
        factor, tip = Factor(problem), Tip(scene, mesh)
        path = follow_path(problem, factor, scene.pressures_mpa, PathSettings(control=scene.load.control))
        tips = [f"{tip.mean_mm(item.state):.3f}" for item in path.states if item.asked]
        tips += ["not reached"] * (len(scene.pressures_mpa) - len(tips))
        numbers = (len(mesh.cells), factor.count, f"{time.process_time() - start:.2f}")
        yield (f"r{refinement}", str(cuts), *tips, *map(str, numbers))


if __name__ == "__main__":
    of = load_bellows(Path(sys.argv[1]))
    header = ("mesh", "cuts", *(f"{p:g} kPa, mm" for p in of.load.pressure_kpa), "cells", "factorisations", "CPU, s")
    sys.stdout.write(as_text(Table(header, tuple(trials(of)), (0, 1))) + "\n")
