"""Words for models, meshes and quantities, as a reader sees them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from studies.results.files import RunSummary

TIP, TIP_FORCE = "tip_mm", "tip_force_n"

# What the report calls a model, in the order of its columns; models not named here follow.
MODELS: Mapping[str, str] = {
    "closed_form_printed": "closed form as printed",
    "closed_form": "closed form",
    "closed_form_balanced": "closed form, balanced",
    "closed_form_seat": "closed form, free pitch",
    "axisymmetric": "axisymmetric",
    "sector": "sector",
    "full3d": "full 3D",
    "paper_closed_form": "paper: closed form",
    "paper_ansys": "paper: ANSYS",
    "paper_experiment": "paper: experiment",
}

# What the report calls a quantity; quantities not named here keep the name of their rows.
QUANTITIES: Mapping[str, str] = {"axisymmetric_full3d_gap_percent": "gap between axisymmetric and full 3D"}


def ordered(models: Iterable[str]) -> list[str]:
    """Models once each, known ones first and in the order of `MODELS`."""
    given = list(dict.fromkeys(models))
    return [*(model for model in MODELS if model in given), *(model for model in given if model not in MODELS)]


def model_label(model: str) -> str:
    """What the report calls a model."""
    return MODELS.get(model, model.replace("_", " "))


def run_label(model: str, level: str) -> str:
    """What the report calls a level of a model."""
    return f"{model_label(model)} {level}".strip()


def models_label(runs: Iterable[RunSummary]) -> str:
    """What the report calls several runs: each model once, with its levels."""
    levels: dict[str, list[str]] = {}
    for run in runs:
        levels.setdefault(run.model, []).append(run.level)
    return "; ".join(run_label(model, ", ".join(of_model)) for model, of_model in levels.items())


def split_key(key: str) -> tuple[str, str]:
    """Model and level of a key such as ``"full3d n24"``."""
    model, _, level = key.partition(" ")
    return model, level
