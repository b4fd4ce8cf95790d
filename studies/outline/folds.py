"""Lengths of the folds of an axisymmetric state, measured in its mesh, beside what `studies.results.measures` has.

Half a fold is the wall from the edge of a ring's seat (the middle of a crest without rings) to the next root's throat:
its middle line has a length, and its ends are so far apart along the axis and across it. Between folds are the seats;
beyond the first and the last are the collars.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

import numpy as np

from meshes.solid import FloatArray
from studies.planning.levels import fineness
from studies.results.measures import Places, curve_length, find_places
from studies.results.rows import Row, row
from studies.results.run_files import load_state
from studies.results.runs import MERIDIAN_ORDERS, Run, run_convergence
from studies.scene.bellows import BellowsScene


@dataclass(frozen=True)
class Folds:
    """Means over the half folds of a state, and how much longer the rest is.

    Attributes
    ----------
    fold_line_mm
        Length of the middle line at rest.
    fold_along_mm, fold_across_mm
        How far its ends are apart along the axis, and across it.
    seats_longer_mm, collars_longer_mm
        What all seats between folds, and both collars with what is at the tip, have lengthened along the axis.
    """

    fold_line_mm: float
    fold_along_mm: float
    fold_across_mm: float
    seats_longer_mm: float
    collars_longer_mm: float


# Names of its rows.
FOLDS: Final = tuple(Folds.__dataclass_fields__)


def measure_folds(places: Places, displacement_mm: FloatArray, tip_mm: float) -> Folds:
    """Measure a state.

    Parameters
    ----------
    places
        Its mesh, and where in it the folds are.
    displacement_mm
        Of the mesh's nodes, shape (nodes, 2).
    tip_mm
        Elongation at the tip.
    """
    first, last = places.sides[:, 0], places.sides[:, -1]
    x = places.points + places.displacement_mm(displacement_mm)
    across, along = np.abs(x[last] - x[first]).mean(axis=0)
    # sides from a seat to a throat come first, then as many from a throat to a seat
    folds = len(places.throats_outside)
    begin, end = displacement_mm[first[:folds], 1], displacement_mm[last[folds:], 1]
    return Folds(
        fold_line_mm=float(curve_length(places.points[places.sides]).mean()),
        fold_along_mm=float(along),
        fold_across_mm=float(across),
        seats_longer_mm=float((begin[1:] - end[:-1]).sum()),
        collars_longer_mm=float(begin[0] + tip_mm - end[-1]),
    )


def fold_rows(scene: BellowsScene, runs: Sequence[Run], folder: Path) -> list[Row]:
    """Rows of the folds of a scene's axisymmetric runs at the requested pressures, with their bands.

    Parameters
    ----------
    runs
        Coarsest first; their saved states are in ``folder / "axisymmetric-<level>"``.
    """
    states = [_folds_of(scene, run, folder) for run in runs]
    rows = []
    for pressure in scene.load.pressure_kpa:
        found = [(run, asdict(at[pressure])) for run, at in zip(runs, states, strict=True) if pressure in at]
        for name in FOLDS if found else ():
            bound = run_convergence([run for run, _ in found], [values[name] for _, values in found], MERIDIAN_ORDERS)
            for run, values in found:
                at = (scene.name, name, "mm", pressure, "axisymmetric", values[name], run.summary.level)
                rows.append(row(*at, bound.uncertainty(values[name])))
    return rows


def _folds_of(scene: BellowsScene, run: Run, folder: Path) -> dict[float, Folds]:
    """The folds of a run's saved states, by requested pressure, kPa."""
    places, found = find_places(scene, fineness(run.summary.level)), {}
    for entry in run.requested:
        saved = load_state(
            folder / f"axisymmetric-{run.summary.level}", run.summary.content_hash, 1e-3 * entry.pressure_kpa
        )
        if saved is not None:
            found[entry.pressure_kpa] = measure_folds(places, saved[0].displacement_mm, entry.tip_mm)
    return found
