"""The list of studies: their names on the command line and where they are."""

from __future__ import annotations

import pkgutil
from collections.abc import Mapping
from typing import Any

from studies.engine import Study

# Studies in the order of a reader's questions, and the module that has each as STUDY.
STUDIES: Mapping[str, str] = {
    "paper": "studies.paper.study",
    "smoke": "studies.smoke.study",
    "closed-form": "studies.closed_form.study",
    "dimensions": "studies.dimensions.study",
    "outline": "studies.outline.study",
    "sweep": "studies.sweep.study",
    "exact": "studies.verification.exact",
    "verification": "studies.verification.study",
    "stability": "studies.stability.study",
    "fuzz": "studies.fuzz.study",
    "modes": "studies.modes.study",
    "branches": "studies.branches.study",
    "imperfection": "studies.imperfection.study",
    "contact": "studies.contact.study",
    "vacuum": "studies.vacuum.study",
    "cost": "studies.cost.study",
    "peers": "studies.peers.study",
    "dual": "studies.dual.study",
    "error-model": "studies.cost.error_model.study",
    "large": "studies.large.study",
    "stacks": "studies.stacks.study",
    "benchmark-closed-form": "studies.closed_form.speed",
    "benchmark-solver": "studies.cost.solver_benchmark",
    "benchmark-start": "studies.cost.start_benchmark",
}


def load_study(name: str) -> Study[Any, Any]:
    """A study by its name, such as ``closed-form``."""
    study: Study[Any, Any] = pkgutil.resolve_name(f"{STUDIES[name]}:STUDY")
    return study
