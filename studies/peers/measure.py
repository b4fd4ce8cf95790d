"""Makes the peer study's measurements, each run a process of its own from start to end on two cores, and keeps them."""

from __future__ import annotations

import ast
import json
import math
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from studies import mpi_children
from studies.peers import environment
from studies.peers.cases import OURS, SCENE, SCRIPTS, Attempt, peer_scene, script_of
from studies.peers.exchange import Level, write_peer_mesh
from studies.results import provenance
from studies.results.kept import content_key, keep, read_kept
from studies.results.rows import read_rows
from studies.scene.text import changed_text

_STOPPED: Final = "stopped after"
# Runs shorter than this are made three times, s: a start of a process alone varies by a tenth of a second.
SHORT_S: Final = 5.0


@dataclass(frozen=True)
class Measurement:
    """What came out of a run; ``reason`` says why there is no tip at the highest pressure.

    ``cpu_s`` is that of all its processes: beside the wall time it shows whether other work was on the cores.
    """

    tip_mm: float
    unknowns: int
    wall_s: float
    peak_mb: float
    lines: int
    reason: str
    cpu_s: float

    @property
    def timed_out(self) -> bool:
        """True if it was stopped at the time limit."""
        return self.reason.startswith(_STOPPED)


def key_of(attempt: Attempt) -> str:
    """Key of a measurement: the run, its scene, and the code that computes it."""
    physics = peer_scene().model_dump(mode="json", exclude={"name", "ask", "compare"})
    run = (physics, attempt.code, attempt.label, attempt.options)
    if attempt.code == OURS:
        return content_key(*run, provenance.code_hash())
    return content_key(*run, sources=[script_of(attempt.code), SCRIPTS / "exchange.py", *environment.LISTS])


def kept_measurement(attempt: Attempt, out: Path) -> Measurement | None:
    """A measurement that is there already."""
    key = key_of(attempt)
    return read_kept(_file(out, key), key, Measurement)


def keep_measurement(attempt: Attempt, out: Path, made: Measurement) -> None:
    """Keep a measurement for `kept_measurement`."""
    key = key_of(attempt)
    keep(_file(out, key), key, made)


def measure(attempt: Attempt, out: Path, limit_s: float) -> Measurement:
    """A new measurement, kept; of a short run the median of three."""

    def once() -> Measurement:
        if attempt.code == OURS:
            return measure_ours(attempt, limit_s)
        return measure_peer(attempt, out / "meshes", limit_s)

    made = once()
    if made.wall_s < SHORT_S and not made.reason:
        three = sorted((one for one in (made, once(), once()) if not one.reason), key=lambda one: one.wall_s)
        made = three[len(three) // 2]
    keep_measurement(attempt, out, made)
    return made


def _file(out: Path, key: str) -> Path:
    return out / "measured" / f"{key}.json"


def measure_peer(attempt: Attempt, meshes: Path, limit_s: float) -> Measurement:
    """A run of another program."""
    assert attempt.level is not None
    if attempt.code.startswith("dolfinx"):  # its forms into the cache
        coarse = Level(attempt.level.cells, 1, 6 if attempt.dimension == 3 else 0)
        _run_peer(attempt.code, coarse, {**attempt.options, "compile_only": True}, meshes, limit_s)
    ended = _run_peer(attempt.code, attempt.level, attempt.options, meshes, limit_s)
    said = ended.said if ended.code != -1 else None
    if said is None:
        said = _nothing(ended)
    elif said["reason"]:
        said["reason"] = f"stopped at {1e3 * said['pressure_mpa']:.3g} kPa: {said['reason']}"
        said["tip_mm"] = math.nan
    return _measurement(script_of(attempt.code), ended, said)


def measure_ours(attempt: Attempt, limit_s: float) -> Measurement:
    """A run of this program, twice: forms are compiled in the first."""
    options = attempt.options
    changes = {
        "rings.model": options["rings"],
        "mesh.element": options["element"],
        "ask.tolerance_percent": options["tolerance"],
    }
    with tempfile.TemporaryDirectory() as folder:
        scene, out = Path(folder, "scene.toml"), Path(folder, "timed")
        scene.write_text(changed_text(SCENE.read_text(encoding="utf-8"), peer_scene().name, changes), encoding="utf-8")
        ended = _run_ours(scene, Path(folder, "warm"), options, limit_s)
        if ended.code == 0:
            ended = _run_ours(scene, out, options, limit_s)
        return _measurement(scene, ended, _result(out) if ended.code == 0 else _nothing(ended))


def _run_ours(scene: Path, out: Path, options: Mapping[str, Any], limit_s: float) -> mpi_children.Ended:
    """Solve a scene as a user does."""
    arguments = ["-m", "studies", "solve", str(scene), "--out", str(out)]
    arguments += ["--model", options["model"]] if options["model"] else []
    ranks: int = options["ranks"]
    return mpi_children.run(mpi_children.on_ranks(ranks, *arguments), _environment(2 // ranks), limit_s)


def _result(out: Path) -> dict[str, Any]:
    """What a folder of results says, by the names that a peer's script uses."""
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    tips = [
        row.value for row in read_rows(out / "rows.csv") if (row.quantity, row.model) == ("tip_mm", summary["model"])
    ]
    return {"tip_mm": tips[-1], "dofs": summary["dofs"], "peak_mb": summary["peak_mb"], "reason": ""}


def _nothing(ended: mpi_children.Ended) -> dict[str, Any]:
    """Of a run that said nothing, why, with the last line it wrote."""
    why = f"exit {ended.code}: {ended.last_line[:200]}"
    if ended.code == -1:
        why = f"{_STOPPED} {ended.wall_s:.0f} s"
    return {"tip_mm": math.nan, "dofs": 0, "peak_mb": math.nan, "reason": why}


def _measurement(written: Path, ended: mpi_children.Ended, said: Mapping[str, Any]) -> Measurement:
    """Of a run that has ended, and what it said of itself."""
    return Measurement(
        tip_mm=said["tip_mm"],
        unknowns=said["dofs"],
        wall_s=ended.wall_s,
        peak_mb=said["peak_mb"],
        lines=lines_to_write(written),
        reason=said["reason"],
        cpu_s=ended.cpu_s,
    )


def _run_peer(code: str, level: Level, options: Mapping[str, Any], meshes: Path, limit_s: float) -> mpi_children.Ended:
    """Write a mesh and run a peer on it."""
    mesh = meshes / f"{level.name}.npz"
    write_peer_mesh(peer_scene(), level, mesh)
    return mpi_children.run(*peer_command(code, mesh.absolute(), options), limit_s)


def peer_command(code: str, mesh: Path, options: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """Command and environment of a peer's run on two cores."""
    arguments = [str(mesh), json.dumps(options)]
    if code.startswith("dolfinx"):
        variables = _environment(1)
        if code.endswith("default_blas"):
            variables["LD_LIBRARY_PATH"] = str(environment.reference_blas())
        return mpi_children.on_ranks(2, "-m", "studies.peers.dolfinx_tutorial", *arguments), variables
    python = sys.executable if code == "calculix" else str(environment.peers_python())
    return [python, str(script_of(code)), *arguments], _environment(2)


def _environment(threads: int) -> dict[str, str]:
    """Environment of a child with so many threads."""
    return {**mpi_children.environment(threads), "OMP_NUM_THREADS": str(threads)}


def lines_to_write(path: Path) -> int:
    """Lines of a script or a scene without blank ones, comments and docstrings."""
    text = path.read_text(encoding="utf-8")
    kept = {n for n, line in enumerate(text.splitlines(), start=1) if line.strip() and not line.strip().startswith("#")}
    for node in ast.walk(ast.parse(text)) if path.suffix == ".py" else ():
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            kept -= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return len(kept)
