"""What has become of an input, held against what is known of it.

``right``: exit 0, and each requested value is confirmed by an exact answer, by a second model, or by another mesh.
``refused``: exit 2, the reason names a key or a place in the file, and nothing was touched. ``stopped``: exit 3 with a
reason. Anything else is ``wrong``, a ``crash`` (an error nobody named, a signal) or a ``time out``.

The second model is the same scene in the other family of cells and with the other control; of one that was forced, the
axisymmetric model; of a user's mesh, the same body as a kind of its own.
"""

from __future__ import annotations

import math
import re
import shutil
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Literal

import tomlkit

from studies.fuzz.draws import Draw
from studies.fuzz.meshfiles import MOVES_MOST
from studies.planning.levels import LIMIT
from studies.results.csv_files import read_lines
from studies.results.rows import NOT_MET, REACHED, Row, misses_tolerance, read_rows
from studies.scene.bellows import BellowsScene
from studies.scene.load import Scene, load_scene

Verdict = Literal["right", "refused", "stopped", "wrong", "crash", "time out"]
VERDICTS: Final[tuple[Verdict, ...]] = ("right", "refused", "stopped", "wrong", "crash", "time out")
# What Python, numpy or a library say when nobody has caught it, whatever the exit code.
LEAKED: Final = re.compile(r"Traceback|File \"[^\"]*\", line|\w*(?:Warning|Error):|PETSC ERROR|Segmentation")
# Errors that were caught and passed on without a reason of one's own.
NAMELESS: Final = re.compile(
    r"division by zero|NoneType|out of bounds|out of range for|not subscriptable|unexpected keyword|zero-size array|"
    r"cannot convert|could not convert|must be real|Singular matrix|shape mismatch|operands could not"
)
# A refusal names a key of the file, or says what of the file cannot be read.
NAMED: Final = re.compile(r"\b[a-z_]+(?:\.[a-z0-9_]+)* ?(?:=|:)|not a TOML file|cannot be read")
# Size that a tolerance is a share of, at least, of the largest value of a quantity; and what a value is held to where
# one mesh alone could not tell its error, percent.
SMALL, UNTOLD_PERCENT = 0.01, 2.0
SOLVED: Final = ("axisymmetric", "sector", "full3d")


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code, standard output and error, and whether its folder is as it was."""

    code: int
    out: str
    error: str
    untouched: bool = False


@dataclass(frozen=True)
class Outcome:
    """What has become of an input.

    Attributes
    ----------
    verdict
        See the module's heading.
    reason
        Why, in words; of a right answer what confirms it.
    error_percent
        Largest difference from what confirms it; NaN where there is none.
    seconds
        Of a core, with what confirms it; compilers and gmsh not counted.
    """

    verdict: Verdict
    reason: str = ""
    error_percent: float = math.nan
    seconds: float = 0.0


Solve = Callable[..., tuple[Ended, Path]]


def judged(draw: Draw, solve: Solve) -> Outcome:
    """The outcome of an input.

    Parameters
    ----------
    solve
        Runs ``solve(text, name, command, model)``, a file's contents, and gives how it ended and its folder.
    """
    ended, out = solve(draw.text, "first", draw.command, draw.model)
    early = not_an_answer(ended)
    if early is not None:
        return early
    if draw.command == "plan":
        return Outcome("right", "planned only")
    if draw.command == "sweep":
        return _of_sweep(out, solve)
    return _of_answer(draw, ended, out, solve)


def not_an_answer(ended: Ended) -> Outcome | None:
    """The outcome of a command that has no answer, or says what it should not; None if it has one."""
    said = " ".join(ended.error.split())
    leak = LEAKED.search(ended.out + ended.error)
    if leak is not None or ended.code not in (0, 2, 3):
        return Outcome("crash", f"exit {ended.code}: {said[-400:]}")
    if ended.code == 0:
        return None
    if not said or NAMELESS.search(said):
        return Outcome("crash", f"exit {ended.code} without a reason: {said[-400:]}")
    if ended.code == 3:
        return Outcome("stopped", said[-400:])
    if not ended.untouched:
        return Outcome("wrong", f"refused, and something was written: {said[-400:]}")
    if not NAMED.search(said):
        return Outcome("wrong", f"refused without a key: {said[-400:]}")
    return Outcome("refused", said[-400:])


# ---- answers -----------------------------------------------------------------------------------------------

Key = tuple[str, float]


def _of_answer(draw: Draw, ended: Ended, out: Path, solve: Solve) -> Outcome:
    """The verdict on a scene that was solved."""
    scene = load_scene(out.with_suffix(".toml"))
    rows = read_rows(out / "rows.csv")
    answers = answers_of(scene, rows)
    if draw.model == "closed_form":
        return Outcome("right", "a closed form: no mesh to confirm")
    if not answers or any(math.isnan(row.value) for row in answers.values()):
        return Outcome("wrong", "exit 0 without an answer")
    if NOT_MET in ended.out + ended.error or any(map(misses_tolerance, rows)):
        return Outcome("wrong", f"exit 0, and the tolerance of {scene.ask.tolerance_percent:g} % is not met")
    if all(row.source.startswith("exact") and math.isfinite(row.value) for row in answers.values()):
        return _held(scene, answers, {key: (row.reference, 0.0) for key, row in answers.items()}, "exact")
    for text in [draw.twin] if draw.twin else second_models(draw.text, draw.model):
        other, place = solve(text, "second")
        found = _told(place, other.code) if other.code in (0, 3) else {}
        if draw.twin:
            found = {(MOVES_MOST, load): replace(row, value=row.reference) for (_, load), row in found.items()}
        if found.keys() >= answers.keys():
            return _held(scene, answers, _values(found), "second model")
        shutil.rmtree(place)
    first = next(iter(answers.values()))
    meshes = list(dict.fromkeys(row.level for row in rows if row.model == first.model and row.level != LIMIT))
    coarser = answers_of(scene, [row for row in rows if row.level in meshes[:-1]])
    if coarser.keys() >= answers.keys():
        return _held(scene, answers, _values(coarser), "another mesh")
    return Outcome("wrong", f"exit 0, and nothing confirms it: {other.error[-200:]}")


def _told(place: Path, code: int) -> dict[Key, Row]:
    """What a second model found; of one that stopped early or missed its tolerance, values whose error it tells."""
    if not (place / "rows.csv").exists():
        return {}
    found = answers_of(load_scene(place.with_suffix(".toml")), read_rows(place / "rows.csv"))
    return {key: row for key, row in found.items() if code == 0 or math.isfinite(row.uncertainty)}


def answers_of(scene: Scene, rows: Sequence[Row]) -> dict[Key, Row]:
    """The answer's rows, the last of its model, by quantity and load; infinite where a path has no such load."""
    wanted = (scene.main_quantity,) if isinstance(scene, BellowsScene) else scene.quantities
    solved = [row for row in rows if row.model in SOLVED and row.quantity in wanted]
    found = {}
    for row in solved:
        none = math.isnan(row.value) and row.status.startswith("none up to")
        load = -1.0 if math.isnan(row.pressure_kpa) else row.pressure_kpa
        if row.model == solved[-1].model:
            found[row.quantity, load] = replace(row, value=math.inf) if none else row
    return found


def _values(rows: Mapping[Key, Row]) -> dict[Key, tuple[float, float]]:
    """Values with their uncertainties, 0 where there is none."""
    return {key: (row.value, row.uncertainty if math.isfinite(row.uncertainty) else 0.0) for key, row in rows.items()}


def _held(scene: Scene, answers: Mapping[Key, Row], known: Mapping[Key, tuple[float, float]], by: str) -> Outcome:
    """Right if each answer is within the scene's tolerance, and the uncertainty of what is known, of that."""
    worst = 0.0
    largest: dict[str, float] = {}
    for (quantity, _), row in answers.items():
        if math.isfinite(row.value):
            largest[quantity] = max(largest.get(quantity, 0.0), abs(row.value))
    faults = []
    for key, row in answers.items():
        value, spread = known[key]
        if math.isinf(row.value) or math.isinf(value):
            if row.value != value:
                faults.append(f"{key[0]}: {row.value:.6g}, {by}: {value:.6g}")
            continue
        told = math.isfinite(row.uncertainty)
        size = max(abs(row.value), SMALL * largest[key[0]])
        allowed = (
            0.01 * (scene.ask.tolerance_percent if told else max(UNTOLD_PERCENT, scene.ask.tolerance_percent)) * size
        )
        error = abs(row.value - value)
        worst = max(worst, 100.0 * error / size if size > 0.0 else 0.0)
        if not error <= allowed + spread:
            faults.append(
                f"{key[0]} at {key[1]:g} kPa: {row.value:.6g} ± {row.uncertainty:.2g}, {by}: {value:.6g} ± {spread:.2g}"
            )
    return Outcome("wrong" if faults else "right", "; ".join(faults) or by, worst)


def second_models(text: bytes, model: str) -> list[bytes]:
    """The same scene to be solved otherwise, the more different first; see this module's heading."""
    # read as a scene's file is: a lone carriage return ends a line, which TOML itself refuses
    scene = tomllib.loads("\n".join(text.decode().splitlines()))
    if model in ("sector", "full3d") or scene["geometry"]["kind"] == "mesh":
        return [_changed(scene, _other_control(scene))]
    cells = scene.get("mesh", {}).get("element", "auto")
    swapped = {"mesh": {**scene.get("mesh", {}), "element": "hex" if cells.startswith("tet") else "tet"}}
    return [
        _changed(scene, {**swapped, **_other_control(scene)}),
        _changed(scene, swapped),
        _changed(scene, _other_control(scene)),
    ]


def _other_control(scene: Mapping[str, Any]) -> dict[str, Any]:
    auto = scene["load"].get("control", "auto") == "auto"
    return {"load": {**scene["load"], "control": "pressure" if auto else "auto"}}


def _changed(scene: Mapping[str, Any], tables: Mapping[str, Any]) -> bytes:
    return tomlkit.dumps({**scene, **tables}).encode()


def _of_sweep(out: Path, solve: Solve) -> Outcome:
    """The verdict on a sweep that was run: its first scene that was solved is solved again in the other cells."""
    lines = read_lines(out / "sweep.csv")
    solved = [line for line in lines if line["status"] == REACHED]
    if not solved or any(line["status"].startswith(("failed", "stopped", "not run")) for line in lines):
        return Outcome("wrong", "exit 0, and not every scene is solved or refused")
    first = solved[0]
    text = (out / "scenes" / first["scene"] / "scene.toml").read_bytes()
    for other in second_models(text, ""):
        ended, place = solve(other, "second")
        if ended.code == 0:
            scene = load_scene(place.with_suffix(".toml"))
            found = answers_of(scene, read_rows(place / "rows.csv"))
            key = (first["quantity"], float(first["pressure_kpa"]))
            mine = replace(found[key], value=float(first["axisymmetric"]), uncertainty=float(first["uncertainty"]))
            return _held(scene, {key: mine}, _values(found), "second model")
        shutil.rmtree(place)
    return Outcome("wrong", f"exit 0, and nothing confirms it: {ended.error[-200:]}")
