"""The closed form's run of a scene: written like any other, though it costs nothing and is not kept."""

from __future__ import annotations

import math
import time
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from analytical.bellows.chains import closed_form
from analytical.bellows.loads import held_tip
from studies.models.build import masses_g
from studies.models.run_log import WARNING, scene_notes
from studies.planning.warnings import stretch_warnings
from studies.results import provenance
from studies.results.run_files import PathRow, RunSummary, write_path, write_summary
from studies.results.runs import Run, run_hash
from studies.scene.bellows import BellowsScene, dimensions_of
from studies.scene.materials import law_of
from studies.scene.meshes import scene_meridian


def run_closed_form(scene: BellowsScene, folder: Path, comm: MPI.Comm) -> Run:
    """The closed form at the requested pressures.

    Raises
    ------
    analytical.bellows.BellowsError
        If it has no answer for the scene.
    """
    begin = time.perf_counter()
    tips, forces, stretches = _tip(scene)
    beyond = stretch_warnings(scene, list(zip(scene.load.pressure_kpa, stretches, strict=True)))
    silicone, rings = masses_g(scene, scene_meridian(scene, 1))
    rows = tuple(
        _row(pressure_kpa=pressure, tip_mm=tip, tip_centre_mm=tip, tip_force_n=force, largest_stretch=stretch)
        for pressure, tip, force, stretch in zip(scene.load.pressure_kpa, tips, forces, stretches, strict=True)
    )
    summary = RunSummary(
        scene=scene.name,
        model="closed_form",
        level="",
        status="reached",
        reason="",
        content_hash=run_hash(scene, "closed_form", ""),
        plan=(*scene_notes(scene), *(WARNING + text for text in beyond)),
        dofs=0,
        cells=0,
        nodes=0,
        factorisations=0,
        newton_iterations=0,
        rejected_steps=0,
        silicone_g=silicone,
        ring_g=rings,
        time_s={"total": time.perf_counter() - begin},
        peak_mb=provenance.peak_memory_mb(comm),
        **provenance.stamp(comm),
    )
    if comm.rank == 0:
        write_path(folder, rows)
        write_summary(folder, summary)
    return Run(summary, rows)


def _tip(scene: BellowsScene) -> tuple[list[float], list[float], list[float]]:
    """Elongations, mm, forces of the actuator at its tip, N, and largest stretches, at the requested pressures."""
    dimensions, law, pressures = dimensions_of(scene), law_of(scene.material), np.array(scene.load.pressure_kpa)
    free, nothing = closed_form(dimensions, law, pressures), [0.0] * len(pressures)
    if scene.blocked:
        held = held_tip(dimensions, law, pressures)
        stretch = np.maximum(free.root_inner_stretch, held.wall_stretch)
        return nothing, held.tip_force_n.ravel().tolist(), stretch.ravel().tolist()
    stretch = np.maximum(free.root_inner_stretch, free.wall_stretch)
    return free.elongation_mm.tolist(), nothing, stretch.ravel().tolist()


def _row(**known: float) -> PathRow:
    """A row of path.csv in which all other figures are unknown."""
    row: dict[str, Any] = {f.name: math.nan for f in fields(PathRow) if f.type == "float"}
    row |= {"control": "pressure", "unstable_by_m": "", "newton_iterations": 0, "wall_s": 0.0, "status": "requested"}
    return PathRow(**{**row, **known})
