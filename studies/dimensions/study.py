"""The study of the dimensions that the paper does not print.

Four printed numbers against about five unknowns: a set of dimensions that fits is not validated by fitting.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import click
import numpy as np

from analytical.bellows.fit.members import WITHIN
from analytical.bellows.paper import PRINTED_MASS_G, PRINTED_PRESSURE_KPA
from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from studies.dimensions import plots, sentences, sets, tables
from studies.dimensions.cases import Steps, cases
from studies.dimensions.fit import Fit, Picks, fit
from studies.dimensions.predictions import Prediction, predictions, unfolding_kpa
from studies.dimensions.rows import fit_rows, members_csv
from studies.dimensions.scenes import FILLET_MM, SEAT_MM, write_scenes
from studies.engine import Bar, Page, Setting, Solved, Study
from studies.results import provenance
from studies.results.run_files import write_text_atomically


def solve(steps: Steps, at: Setting) -> Fit:
    """Everything that is found with steps."""
    return fit(steps)


def page(solved: Sequence[Solved[Steps, Fit]], at: Setting) -> Page:
    """Rows, pictures, members.csv, and the scenes of the three sets."""
    ((steps, found),) = ((done.case, done.result) for done in solved)
    predicted = predictions(found)
    write_text_atomically(at.out / "members.csv", members_csv(found))
    keep_scenes(found.picks, at)
    sets.keep_sets(found.drawn, at.out, bool(at.options["write_scenes"]))
    pictures = at.out / "pictures"
    plots.draw_outlines(pictures / "outlines.png", found)
    plots.draw_members(pictures / "members.png", found)
    plots.draw_spread(pictures / "spread.png", found, predicted)
    plots.draw_paths(pictures / "paths.png", found)
    return Page(
        fit_rows(found, predicted),
        content(steps, found, predicted),
        bars=[recorded(found.picks), sets.sets_recorded(found.drawn)],
    )


def keep_scenes(picks: Picks, at: Setting) -> None:
    """Write the scenes of the three sets into the study's folder, and into scenes/ if that is requested and right."""
    write_scenes(at.out / "scenes", picks.families)
    if at.options["write_scenes"] and picks.as_recorded:
        for path in write_scenes(provenance.ROOT / "scenes", picks.families):
            click.echo(f"scene: {path}")


def recorded(picks: Picks) -> Bar:
    """Whether the rule gives what analytical/bellows/paper.py records."""
    wanted = "The rule picks the three sets that FAMILIES of analytical/bellows/paper.py records"
    found = "the same" if picks.as_recorded else f"{picks.families}: edit FAMILIES, or find out why"
    return Bar(wanted, found, picks.as_recorded)


def content(steps: Steps, found: Fit, predicted: Sequence[Prediction]) -> dict[str, Any]:
    """What the page shows."""
    thin_larger = unfolding_kpa(found.members)[:, 1]
    return {
        "count": len(found.members),
        "combinations": f"{found.grid.combinations / 1e6:.0f} million",
        "within": f"{100.0 * WITHIN:g}",
        "steps": steps,
        "density": SILICONE_DENSITY_G_CM3,
        "fillet": FILLET_MM,
        "seat": SEAT_MM,
        "mass_window": sentences.mass_window(),
        "printed_mass": PRINTED_MASS_G,
        "thin_share": f"{100.0 * np.mean(thin_larger <= PRINTED_PRESSURE_KPA):.1f}",
        "differences": sentences.differences(predicted),
        "orders": sentences.orders(found),
        "runners_up": sentences.runners_up(found),
        "finer_grids": sentences.finer_grids(found),
        "single_masses": sentences.single_masses(found),
        "sets": tables.sets(found),
        "found": tables.what_fits(found),
        "candidates": tables.candidates(found),
        "rules": tables.rules(found),
        "fitted": tables.fitted(found),
        "saturation": tables.saturation(found),
        "spread": tables.spread(found, predicted),
        "chains": tables.chains(found),
        "masses": tables.masses(found),
        "drawn": sets.drawn_table(found.drawn),
        "chosen": sets.chosen_table(found.drawn),
        "scenes": [f"`{actuator.name}`" for of_set in found.sets for actuator in of_set.actuators],
    }


STUDY: Final = Study(
    name="dimensions",
    title="The dimensions that the paper does not print: what fits, and what depends on it",
    question="Which dimensions meet the paper's closed-form numbers, and how far do predictions differ between them?",
    template="dimensions/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    options=(
        click.Option(
            ["--write-scenes"],
            is_flag=True,
            help="Also write the three sets' scenes, and sets.csv, into scenes/.",
        ),
    ),
)
