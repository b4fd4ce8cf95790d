"""Errors that a bellows' axisymmetric run tells of its own mesh, beside its tip in ``path.csv``."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

from solvers.estimate.enriched import Enriched
from studies.models.contact import MODELLED
from studies.models.errors.estimates import errors_of, richer_problem
from studies.results.run_files import load_state, write_path
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene


def with_errors(scene: BellowsScene, folder: Path, run: Run) -> Run:
    """A run with the errors of its tip at requested pressures, made if they are not there; one rank calls.

    Parameters
    ----------
    scene, folder
        The scene, and where the run is kept, its states among it.
    run
        A finished run; it is left without where it stopped early, or contact was modelled, which richer spaces lack.
    """
    asked = run.requested
    modelled = any(note.startswith(MODELLED) for note in run.summary.plan)
    known = all(not math.isnan(row.tip_error_mm) for row in asked)
    if known or modelled or run.summary.status != "reached":
        return run
    kept = [load_state(folder, run.summary.content_hash, 1e-3 * row.pressure_kpa) for row in asked]
    states = [found[0] for found in kept if found is not None]
    if len(states) < len(asked):
        return run
    problem, quantities = richer_problem(scene, run.summary.level)
    enriched = Enriched(problem)
    errors = [found["tip_mm"] for found in errors_of(enriched, states, quantities)]
    enriched.factor.close()
    by_row = {id(row): error for row, error in zip(asked, errors, strict=True)}
    rows = tuple(dataclasses.replace(row, tip_error_mm=by_row.get(id(row), math.nan)) for row in run.path)
    write_path(folder, rows)
    return dataclasses.replace(run, path=rows)
