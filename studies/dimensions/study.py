"""The study of the dimensions that the paper does not print: report, rows, pictures and scene files.

Four printed numbers against about five unknowns: a set of dimensions that fits is not validated by fitting.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytical.bellows.fit.members import WITHIN
from analytical.bellows.paper import PRINTED_MASS_G, PRINTED_PRESSURE_KPA
from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from studies.dimensions import plots as dimension_plots
from studies.dimensions import tables as dimension_tables
from studies.dimensions.fit import (
    DRAWING_STEP_MM,
    MOULD_STEP_MM,
    SEARCH_STEP_MM,
    DimensionStudy,
    Prediction,
    predictions,
    run_study,
    unfolding_kpa,
    write_data,
)
from studies.dimensions.scenes import scene_of, write_scenes
from studies.report.numbers import duration
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance

TITLE: Final = "The dimensions that the paper does not print: what fits, and what depends on it"
SCENES_FOLDER: Final = "scenes"
# What the numbers and pictures of this study depend on.
_VERSIONS: Final = ("python", "numpy", "scipy", "matplotlib")


def write_study(folder: Path) -> DimensionStudy:
    """Write report.md, report.html, rows.csv, members.csv, pictures/ and scenes/ of the study.

    Parameters
    ----------
    folder
        Where to; made if missing.

    Returns
    -------
    DimensionStudy
        What was found; `Picks.as_recorded` says whether analytical/bellows/paper.py still holds it.
    """
    begin = time.perf_counter()
    study = run_study()
    predicted = predictions(study)
    write_data(study, predicted, folder)
    write_scenes(folder / SCENES_FOLDER, study.picks.families)
    pictures = folder / "pictures"
    dimension_plots.draw_outlines(pictures / "outlines.png", study)
    dimension_plots.draw_members(pictures / "members.png", study)
    dimension_plots.draw_spread(pictures / "spread.png", study, predicted)
    dimension_plots.draw_paths(pictures / "paths.png", study)
    write_page(folder, "dimensions.md.j2", _content(study, predicted) | {"wall": duration(time.perf_counter() - begin)})
    return study


def _content(study: DimensionStudy, predicted: tuple[Prediction, ...]) -> dict[str, Any]:
    """What the template shows."""
    tables = dimension_tables
    shares = 100.0 * np.mean(unfolding_kpa(study.members) <= PRINTED_PRESSURE_KPA, axis=0)
    return {
        "title": TITLE,
        "count": len(study.members),
        "combinations": f"{study.grid.combinations / 1e6:.0f} million",
        "within": f"{100.0 * WITHIN:g}",
        "search_step": f"{SEARCH_STEP_MM:g}",
        "drawing_step": f"{DRAWING_STEP_MM:g}",
        "mould_step": f"{MOULD_STEP_MM:g}",
        "density": f"{SILICONE_DENSITY_G_CM3:g}",
        "fillet": f"{scene_of(study.actuators[0][0]).geometry.fillet_mm:g}",
        "seat": f"{study.fittings.seat_mm:g}",
        "mass_window": tables.mass_window(),
        "printed_mass": f"{PRINTED_MASS_G:g}",
        "thin_share": f"{shares[1]:.1f}",
        "differences": tables.differences(predicted),
        "verdict": tables.verdict(study),
        "orders": tables.orders(study),
        "runners_up": tables.runners_up(study),
        "finer_grids": tables.finer_grids(study),
        "single_masses": tables.single_masses(study),
        "sets": tables.sets(study),
        "found": tables.found(study),
        "candidates": tables.candidates(study),
        "rules": tables.rules(study),
        "fitted": tables.fitted(study),
        "saturation": tables.saturation(study),
        "spread": tables.spread(study, predicted),
        "chains": tables.chains(study),
        "masses": tables.masses(study),
        "scenes": [f"`{actuator.name}`" for of_set in study.actuators for actuator in of_set],
        "provenance": _provenance(),
    }


def _provenance() -> Table:
    versions = {name: value for name, value in provenance.versions().items() if name in _VERSIONS}
    stamps = {"commit": provenance.commit(), "date": provenance.now(), "machine": provenance.machine(), **versions}
    return facts_table(stamps)
