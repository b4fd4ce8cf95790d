"""The error model's study: made-up bellows and ten others on three or four meridians, shared out over the ranks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final

import click

from studies.cost.error_model.cases import KINDS, PREFIX, Trial, cases
from studies.cost.error_model.checks import check_rows, checks_table, factors_table
from studies.cost.error_model.fit import Sample, fit, limits_of, sample, time_laws
from studies.engine import Page, Setting, Solved, Study
from studies.results.rows import read_rows
from studies.results.run_files import write_text_atomically


def solve(trial: Trial, at: Setting) -> Sample:
    """The runs of a scene."""
    return sample(trial, trial.levels, at.out / "runs", at.comm, at.progress)


def page(solved: Sequence[Solved[Trial, Sample]], at: Setting) -> Page:
    """The constants that `studies.planning.error_model` holds, and how well they foretell the ten scenes."""
    text = json.dumps([asdict(done.result) for done in solved], indent=1)
    write_text_atomically(at.out / "samples.json", text + "\n")
    limits = limits_of([done.result for done in solved])
    known = [done for done in solved if done.result.scene in limits]
    trained = [done.result for done in known if done.case.scene.name.startswith(PREFIX)]
    rows = [
        r
        for done in known
        if not done.case.scene.name.startswith(PREFIX)
        for r in check_rows(done.case.scene, done.result, limits)
    ]
    cost: Path = at.options["cost"]
    content = {
        "fits": {cells: fit(trained, limits, cells) for cells in KINDS},
        "seconds": time_laws(read_rows(cost) if cost.exists() else []),
        "factors": factors_table(rows),
        "checks": checks_table(rows),
    }
    return Page(rows, content)


STUDY: Final = Study(
    name="error-model",
    title="What meshes leave of error and take of time, foretold before solving",
    question="How well are error and time of a mesh foretold, on scenes that the fit has not seen?",
    template="cost/error_model/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    options=(
        click.Option(
            ["--cost"],
            default="results/cost/rows.csv",
            type=click.Path(path_type=Path),
            help="Rows of the cost study.",
        ),
    ),
)
