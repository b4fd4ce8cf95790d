"""Rows of the study of the unprinted dimensions, and the file of all sets that fit."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Final

import numpy as np

from analytical.arrays import FloatArray, IntArray
from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import CHAINS, PRESSURES_KPA, printed_mm
from analytical.bellows.fit.masses import rings_g, silicone_g
from analytical.bellows.fit.members import ORDERS, SILICONES, wall_stretch
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, SOURCE, PaperActuator
from studies.dimensions.fit import Fit
from studies.dimensions.predictions import Prediction, rest_length_mm
from studies.dimensions.scenes import FITTINGS
from studies.report.labels import TIP
from studies.results.rows import REACHED, Row, row

# The actuators of a set that is none of the three.
_SHORT: Final = ("t1-ri5", "t1-larger-ri", "t2-ri5", "t2-larger-ri")


def fit_rows(found: Fit, predicted: Sequence[Prediction]) -> list[Row]:
    """The picked sets at all pressures, and the range of every prediction over all members."""
    rows = []
    for k, of_set in enumerate(found.sets):
        for j, actuator in enumerate(of_set.actuators):
            rows += _tip_rows(actuator)
            for prediction in predicted:
                q = prediction.quantity
                if q.name != TIP:
                    value = float(prediction.picks[k, j])
                    rows.append(row(actuator.name, q.name, q.unit, q.pressure_kpa, q.model, value))
            for name, mass in zip(("silicone_g", "ring_g"), of_set.meshed_g[j], strict=True):
                rows.append(row(actuator.name, name, "g", np.nan, "axisymmetric", float(mass), "r1"))
    for prediction in predicted:
        q = prediction.quantity
        for j, short in enumerate(_SHORT):
            for level, value in zip(("least", "greatest"), extremes(prediction.members[:, j]), strict=True):
                rows.append(row(f"all-that-fit-{short}", q.name, q.unit, q.pressure_kpa, q.model, value, level))
    return rows


def _tip_rows(actuator: PaperActuator) -> list[Row]:
    """Tip of an actuator by the three chains, and what is printed."""
    rows, printed = [], printed_mm(actuator)
    for model, reading in CHAINS.items():
        path = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA, reading)
        for p, tip, state in zip(PRESSURES_KPA, path.elongation_mm, path.state, strict=True):
            is_printed = p == PRINTED_PRESSURE_KPA
            entry = row(
                actuator.name,
                TIP,
                "mm",
                p,
                model,
                float(tip),
                reference=printed["paper_closed_form"] if is_printed else np.nan,
                source=f"{SOURCE}, closed form: fitted, no validation" if is_printed else "",
                status=str(state) if state == "past the model" else REACHED,
            )
            rows.append(entry)
    rows += [
        row(actuator.name, TIP, "mm", PRINTED_PRESSURE_KPA, model, value, source=SOURCE)
        for model, value in printed.items()
    ]
    return rows


def extremes(values: FloatArray) -> tuple[float, float]:
    """Smallest and largest."""
    return float(np.min(values)), float(np.max(values))


def members_csv(found: Fit) -> str:
    """All sets that fit as CSV; lengths in mm, masses as the mean of four actuators in g, errors in percent."""
    members = found.fitting
    errors = 100.0 * members.error
    columns: dict[str, list[str]] = {
        **{f"silicone_{name}": [SILICONES[s] for s in members.silicone[:, j]] for j, name in enumerate(_SHORT)},
        "reading_order": [str(ORDERS[order]) for order in members.order],
        "crest_radius_mm": _texts(members.crest_radius_mm, "g"),
        "larger_root_radius_mm": _texts(members.larger_root_radius_mm, "g"),
        "half_pitch_mm": _texts(members.half_pitch_mm, "g"),
        "convolutions": _texts(members.convolutions, "d"),
        **{f"error_percent_{name}": _texts(errors[:, j], ".3f") for j, name in enumerate(_SHORT)},
        "worst_error_percent": _texts(100.0 * members.worst_error, ".3f"),
        "largest_wall_stretch": _texts(wall_stretch(members).max(axis=1), ".4f"),
        "rest_length_mm": _texts(rest_length_mm(members)[:, 0], "g"),
        "silicone_g": _texts(silicone_g(members, FITTINGS).mean(axis=1), ".2f"),
        "rings_g": _texts(rings_g(members, FITTINGS).mean(axis=1), ".2f"),
        "mass_allowed": ["yes" if allowed else "no" for allowed in found.allowed],
        "mass_with_rings_allowed": ["yes" if allowed else "no" for allowed in found.allowed_with_rings],
    }
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return stream.getvalue()


def _texts(values: FloatArray | IntArray, form: str) -> list[str]:
    return [format(value, form) for value in values.tolist()]
