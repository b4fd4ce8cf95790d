"""Tensile tests in CSV files, and what a law fitted to them is in a scene."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from analytical.arrays import FloatArray
from analytical.exact.homogeneous import MODES, path_stretches
from analytical.tensile.families import FAMILIES, law_name
from analytical.tensile.fitting import Fit, FitError, best_fit
from analytical.tensile.measured import MaterialTest, MeasuredError
from studies.scene.compare import number_in, read_table
from studies.scene.sections import SceneError

# Columns that tell how far a specimen is stretched, and how to have the stretch from them.
STRETCHES: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "stretch": lambda v: v,
    "strain": lambda v: 1.0 + v,
    "strain_percent": lambda v: 1.0 + 0.01 * v,
    "true_strain": np.exp,
}
# Columns of stress, nominal (force per undeformed area) or true (per deformed area), and their unit in MPa; a psi is
# 4.4482216 N on the square of 25.4 mm.
STRESSES: Mapping[str, float] = {
    f"{measure}_{unit}": factor
    for measure in ("nominal", "true")
    for unit, factor in (("kpa", 1e-3), ("mpa", 1.0), ("psi", 4.4482216 / 25.4**2))
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
    names, lines = read_table(path, where)
    header = [name.lower() for name in names]
    along, across = ([name for name in header if name in known] for known in (STRETCHES, STRESSES))
    if len(along) != 1 or len(across) != 1:
        raise SceneError(
            f"{where}: its header is {', '.join(header) or 'empty'}; wanted are one of {', '.join(STRETCHES)} and one "
            f"of {', '.join(STRESSES)}; also mode ({', '.join(MODES)}) and weight"
        )

    def column(name: str) -> FloatArray:
        return np.array([number_in(line, header.index(name), where) for line in lines])

    if not lines:
        raise SceneError(f"{where}: a header and no line of numbers")
    with np.errstate(over="ignore"):  # a logarithm of a thousand is told as the stretch that it is
        stretch = STRETCHES[along[0]](column(along[0]))
    nominal = STRESSES[across[0]] * column(across[0]) / (stretch if across[0].startswith("true") else 1.0)
    place = header.index("mode") if "mode" in header else -1
    given = [line[place].replace("_", " ") if place < len(line) else "" for line in lines] if place >= 0 else []
    modes = np.array(given or ["uniaxial"] * len(stretch))
    weights = column("weight") if "weight" in header else np.ones(len(stretch))
    try:
        return [
            MaterialTest(mode, stretch[modes == mode], nominal[modes == mode], weights[modes == mode])
            for mode in dict.fromkeys(modes.tolist())
        ]
    except MeasuredError as error:
        raise SceneError(f"{where}: {error}") from None


def up_to(tests: Sequence[MaterialTest], stretch: float | None, key: str = "material") -> list[MaterialTest]:
    """Tests without the points beyond a stretch, in their largest principal one.

    Raises
    ------
    SceneError
        If too few are left.
    """
    if stretch is None:
        return list(tests)
    most = stretch * (1.0 + 1e-12)
    try:
        return [test.where(np.max(path_stretches(test.mode, test.stretch), axis=0) <= most) for test in tests]
    except MeasuredError as error:
        raise SceneError(f"{key}.data: up to stretch {stretch:g} there are {error}") from None


def families_of(law: object, key: str = "material") -> list[str]:
    """Names of `FAMILIES` that a law's name stands for: "yeoh" for all numbers of terms, "auto" for all.

    Raises
    ------
    SceneError
        For a name that stands for none.
    """
    found = [name for name in FAMILIES if law in (AUTO, name, law_name(name))]
    if not found:
        raise SceneError(f"{key}.law = {law!r}: fitted are {AUTO}, {', '.join(FAMILIES)}, or without the number")
    return found


def fits_of(
    tests: Sequence[MaterialTest],
    law: object = AUTO,
    stable_to: float | None = None,
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
        return best_fit(tests, names, stable_to)
    except (FitError, MeasuredError) as error:
        raise SceneError(f"{key}.data: {error}") from None


def material_of(fit: Fit) -> dict[str, Any]:
    """A fitted law as the keys of a scene's material."""
    numbers = [float(f"{value:.{DIGITS}g}") for value in fit.constants]
    named: dict[str, Any] = dict(zip(fit.names, numbers, strict=True))
    law = law_name(fit.family)
    if law in ("mooney-rivlin", "yeoh"):
        named = {"c_kpa": numbers}
    elif law == "ogden":
        terms = len(numbers) // 2
        mu, alpha = numbers[:terms], numbers[terms:]
        one = terms == 1
        named = {"mu_kpa": mu[0] if one else mu, "alpha": alpha[0] if one else alpha, "convention": "2mu/alpha^2"}
    return {"law": law, **named, "data_to_stretch": float(f"{fit.data_to_stretch:.4g}")}


@functools.lru_cache(maxsize=16)
def _fitted(path: Path, changed_ns: int, law: str, largest: float | None, key: str) -> dict[str, Any]:
    tests = up_to(read_tests(path, f"{key}.data"), largest, key)
    return material_of(fits_of(tests, law, key=key)[0])


def fitted_material(path: Path, law: str, largest: float | None, key: str) -> dict[str, Any]:
    """The law fitted to a file as the keys of a scene's material; of a file that has not changed it is kept.

    A sweep reads its base's material for every scene, and a fit takes a second.

    Parameters
    ----------
    path, law, largest
        As in `read_tests`, `fits_of` and `up_to`.
    key
        Of the material, for messages.

    Raises
    ------
    SceneError
        From these.
    """
    changed_ns = path.stat().st_mtime_ns if path.exists() else 0
    return dict(_fitted(path, changed_ns, law, largest, key))
