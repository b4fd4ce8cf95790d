"""Tensile tests in CSV files, and what a law fitted to them is in a scene."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from analytical.arrays import FloatArray
from analytical.laws.stability import MODES
from analytical.tensile.families import FAMILIES
from analytical.tensile.fitting import Fit, FitError, best_fit
from analytical.tensile.measured import MaterialTest, MeasuredError
from studies.scene.compare import DELIMITERS
from studies.scene.sections import SceneError

# Columns that tell how far a specimen is stretched, and how to have the stretch from them.
STRETCHES: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "stretch": lambda v: v,
    "strain": lambda v: 1.0 + v,
    "strain_percent": lambda v: 1.0 + 0.01 * v,
    "true_strain": np.exp,
}
# Columns of stress, nominal (force per undeformed area) or true (per deformed area), and their unit in MPa.
STRESSES: Mapping[str, float] = {
    f"{measure}_{unit}": factor
    for measure in ("nominal", "true")
    for unit, factor in (("kpa", 1e-3), ("mpa", 1.0), ("psi", 6.894757e-3))
}
# Digits of constants in scenes and tables: more than a fit has.
DIGITS = 6
AUTO = "auto"


def read_tests(path: Path, key: str = "material.data") -> list[MaterialTest]:
    """The tests of a CSV file: a column of STRETCHES, one of STRESSES, and if wanted ``mode`` and ``weight``.

    Other columns and lines that begin with # are passed over; without ``mode`` the test is uniaxial.

    Raises
    ------
    SceneError
        If it cannot be read, or a column or a number is missing or makes no sense.
    """
    where = f"{key} = {str(path)!r}"
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise SceneError(f"{where}: cannot be read ({error})") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    delimiter = max(DELIMITERS, key=lines[0].count) if lines else ","
    table = [[cell.strip() for cell in line] for line in csv.reader(lines, delimiter=delimiter)]
    header = [name.lower() for name in table[0]] if table else []
    along, across = ([name for name in header if name in known] for known in (STRETCHES, STRESSES))
    if len(along) != 1 or len(across) != 1:
        raise SceneError(
            f"{where}: its header is {', '.join(header) or 'empty'}; wanted are one of {', '.join(STRETCHES)} and one "
            f"of {', '.join(STRESSES)}; also mode ({', '.join(MODES)}) and weight"
        )

    def column(name: str) -> FloatArray:
        return np.array([_number(line, header.index(name), where) for line in table[1:]])

    stretch = STRETCHES[along[0]](column(along[0]))
    nominal = STRESSES[across[0]] * column(across[0]) / (stretch if across[0].startswith("true") else 1.0)
    if len(table) < 2:
        raise SceneError(f"{where}: a header and no line of numbers")
    place = header.index("mode") if "mode" in header else -1
    given = [line[place].replace("_", " ") if place < len(line) else "" for line in table[1:]] if place >= 0 else []
    modes = np.array(given or ["uniaxial"] * len(stretch))
    weights = column("weight") if "weight" in header else np.ones(len(stretch))
    try:
        return [
            MaterialTest(mode, stretch[modes == mode], nominal[modes == mode], weights[modes == mode])
            for mode in dict.fromkeys(modes.tolist())
        ]
    except MeasuredError as error:
        raise SceneError(f"{where}: {error}") from None


def _number(line: Sequence[str], place: int, where: str) -> float:
    text = line[place] if place < len(line) else ""
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise SceneError(f"{where}: {text!r} in the line {', '.join(line)!r} is no number: decimals have a point")
    return found


def up_to(tests: Sequence[MaterialTest], stretch: float | None) -> list[MaterialTest]:
    """Tests without the points beyond a stretch, in their largest principal one.

    Raises
    ------
    MeasuredError
        If too few are left.
    """
    if stretch is None:
        return list(tests)
    kept = []
    for test in tests:
        near = np.max(MODES[test.mode](test.stretch), axis=0) <= stretch * (1.0 + 1e-12)
        kept.append(test.where(near))
    return kept


def families_of(law: object, key: str = "material") -> list[str]:
    """Names of `FAMILIES` that a law's name stands for: "yeoh" for all numbers of terms, "auto" for all.

    Raises
    ------
    SceneError
        For a name that stands for none.
    """
    found = [name for name in FAMILIES if law in (AUTO, name, name.rstrip("0123456789-"))]
    if not found:
        raise SceneError(f"{key}.law = {law!r}: fitted are {AUTO}, {', '.join(FAMILIES)}, or without the number")
    return found


def fits_of(
    tests: Sequence[MaterialTest],
    law: object = AUTO,
    stable_to: float | None = None,
    largest: float | None = None,
    key: str = "material",
) -> list[Fit]:
    """Laws fitted to tests, the best first.

    Parameters
    ----------
    tests
        Of one material.
    law
        As in `families_of`. Of "auto" laws of both invariants are left out where there is one kind of test only, which
        tells nothing of the others: they would be right there and anything elsewhere.
    stable_to
        Stretch to which moduli must be positive; None for the data's largest.
    largest
        Points beyond this stretch are left out.
    key
        Of the material, for messages.

    Raises
    ------
    SceneError
        If none can be fitted.
    """
    names = families_of(law, key)
    if law == AUTO and len({test.mode for test in tests}) == 1:
        names = [name for name in names if FAMILIES[name].one_test]
    try:
        return best_fit(up_to(tests, largest), names, stable_to)
    except (FitError, MeasuredError) as error:
        raise SceneError(f"{key}.data: {error}") from None


def material_of(fit: Fit) -> dict[str, Any]:
    """A fitted law as the keys of a scene's material."""
    numbers = [float(f"{value:.{DIGITS}g}") for value in fit.constants]
    named: dict[str, Any] = dict(zip(fit.names, numbers, strict=True))
    law = fit.family.rstrip("0123456789-")
    if law in ("mooney-rivlin", "yeoh"):
        named = {"c_kpa": numbers}
    elif law == "ogden":
        terms = len(numbers) // 2
        mu, alpha = numbers[:terms], numbers[terms:]
        one = terms == 1
        named = {"mu_kpa": mu[0] if one else mu, "alpha": alpha[0] if one else alpha, "convention": "2mu/alpha^2"}
    return {"law": law, **named, "data_to_stretch": float(f"{fit.data_to_stretch:.4g}")}
