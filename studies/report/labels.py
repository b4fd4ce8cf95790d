"""Words for models, meshes and quantities, as a reader sees them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from studies.results.run_files import RunSummary

TIP, TIP_FORCE = "tip_mm", "tip_force_n"

# What the report calls a model, in the order of its columns; models not named here follow.
MODELS: Mapping[str, str] = {
    "closed_form_printed": "closed form as printed",
    "closed_form": "closed form",
    "closed_form_balanced": "closed form, balanced",
    "closed_form_seat": "closed form, free pitch",
    "closed_form_outline": "closed form, outline's wall",
    "axisymmetric": "axisymmetric",
    "sector": "sector",
    "full3d": "full 3D",
    "paper_closed_form": "paper: closed form",
    "paper_ansys": "paper: ANSYS",
    "paper_experiment": "paper: experiment",
    "measured": "measured",
}

# What the report calls a quantity; quantities not named here keep the name of their rows.
QUANTITIES: Mapping[str, str] = {
    "axisymmetric_full3d_gap_percent": "gap between axisymmetric and full 3D",
    "bore_mm": "radial displacement of the bore",
    "volume_mm3": "enclosed volume",
    "displacement_max_mm": "largest displacement",
    "tip_mm": "axial displacement of the tip",
    "tip_centre_mm": "axial displacement of the tip's centre",
    "tip_force_n": "force at the blocked tip",
    "reaction_n": "axial force of the support",
    "torque_nmm": "torque",
    "axial_force_n": "axial force",
    "corner_mm": "displacement of the corner",
    "apex_inside_mm": "position of the apex inside",
    "apex_outside_mm": "position of the apex outside",
    "unstable_modes": "unstable modes",
    "min_det_f": "least det F",
    "min_gap_mm": "least gap",
    "contact_force_n": "contact force",
    "largest_stretch": "largest stretch",
    "whole_residual": "residual of the whole body by its load",
    "limit_kpa": "limit point of the pressure",
    "crossing_kpa": "loss of stability",
    "bond_slip_rms_mm": "slip of the bond, root mean square",
    "predicted_error_percent": "error expected before solving",
    "checked_error_percent": "error found by the check",
    "predicted_work_s": "work expected before solving, s",
    "work_s": "work done, s",
    "silicone_g": "mass of the silicone",
    "ring_g": "mass of the rings",
}
# Unit of a quantity by how its name ends; those without such an end have none.
_UNITS: Mapping[str, str] = {
    "mm": "mm",
    "mm3": "mm³",
    "kpa": "kPa",
    "n": "N",
    "nmm": "N mm",
    "mj": "mJ",
    "g": "g",
    "percent": "%",
}
# Geometries whose cells are counted along an edge, not round an axis.
_WITH_EDGES = ("block", "cook")
# Names of meshes in files: cells counted along a circle or an edge, refinement of the meridian they are made from.
_LEVEL = re.compile(r"(?:n(?P<cells>\d+))?(?:r(?P<refinement>\d+))?")


def ordered(models: Iterable[str]) -> list[str]:
    """Models once each, known ones first and in the order of `MODELS`."""
    given = list(dict.fromkeys(models))
    return [*(model for model in MODELS if model in given), *(model for model in given if model not in MODELS)]


def model_label(model: str) -> str:
    """What the report calls a model."""
    return MODELS.get(model, model.replace("_", " "))


def quantity_label(quantity: str) -> str:
    """What the report calls a quantity, with its unit."""
    unit = _UNITS.get(quantity.rpartition("_")[2], "")
    return f"{QUANTITIES.get(quantity, quantity)}{f', {unit}' if unit else ''}"


def counted_along(kind: str) -> str:
    """What the cells of a mesh such as ``n8`` are counted along, by the kind of its geometry."""
    return "along an edge" if kind in _WITH_EDGES else "round"


def level_label(level: str, counted: str = "round") -> str:
    """What the report calls a mesh: ``8 cells round, level 2`` for ``n8r2``; names that are not of this form stay.

    Parameters
    ----------
    level
        Name of the mesh.
    counted
        What its cells are counted along.
    """
    found = _LEVEL.fullmatch(level)
    if found is None or not level:
        return level
    cells = f"{found['cells']} cells {counted}" if found["cells"] else ""
    refinement = f"level {found['refinement']}" if found["refinement"] else ""
    return ", ".join(filter(None, (cells, refinement)))


def run_label(model: str, *levels: str, counted: str = "round") -> str:
    """What the report calls a model on one or more meshes."""
    names = [level_label(level, counted) for level in levels if level]
    listed = " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
    return f"{model_label(model)}, {listed}" if listed else model_label(model)


def runs_label(runs: Iterable[RunSummary], counted: str = "round") -> str:
    """What the report calls several runs: each model once, with its meshes."""
    levels: dict[str, list[str]] = {}
    for run in runs:
        levels.setdefault(run.model, []).append(run.level)
    return "; ".join(run_label(model, *of_model, counted=counted) for model, of_model in levels.items())


def split_key(key: str) -> tuple[str, str]:
    """Model and level of a key such as ``"full3d n24"``."""
    model, _, level = key.partition(" ")
    return model, level
