"""Other codes on the same problem in the same run: tip and error, wall time, memory and lines of each, beside ours.

``python -m studies.peers.study --out results/peers`` runs every script of `studies.peers` on meshes that this program
makes, and this program on the same scene; each run is a process of its own on two cores, from start to end, with
compiled forms in dolfinx's cache. Finished measurements are kept by content and not repeated. A code that is missing is
skipped with a line.
"""

from __future__ import annotations

import ast
import hashlib
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import click
from mpi4py import MPI

from studies import launch
from studies.models.axisymmetric import run_axisymmetric
from studies.peers import environment
from studies.peers.exchange import Cells, Level, write_peer_mesh
from studies.peers.fronts import Point, floored, lasting, ratio_at_equal_error, ratio_to_fastest
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import REACHED, Row, row, write_rows
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows

SCENE = provenance.ROOT / "scenes" / "peers" / "bellows.toml"
SCRIPTS = provenance.ROOT / "studies" / "peers"
# What a run may take, s, and what our own must hold, percent.
TIME_LIMIT_S, ALLOWED_PERCENT = 1200.0, 1.0
REFERENCE_LEVELS = (4, 8)
# The reference is known to this, percent: what the finest triangles with meshed rings and the finest quadrilaterals
# with rigid ones differ by, with room (0.0125 at 10 kPa on r8).
REFERENCE_PERCENT = 0.02


@dataclass(frozen=True)
class Attempt:
    """A run to be made.

    Attributes
    ----------
    code
        ``calculix``, ``ngsolve``, ``felupe``, ``dolfinx_tutorial``, ``dolfinx_tutorial_default_blas``, or ``ours``.
    dimension
        2 for axisymmetric, 3 for full 3D.
    label
        Mesh and setting.
    level
        The peer's mesh; None for ours.
    options
        The script's options; of ours: model, element, rings, tolerance, ranks.
    """

    code: str
    dimension: int
    label: str
    level: Level | None
    options: dict[str, Any]


@dataclass(frozen=True)
class Measurement:
    """What came out of it; ``reason`` says why there is no tip at the highest pressure.

    ``cpu_s`` is that of all its processes: beside the wall time it shows whether other work was on the cores.
    """

    code: str
    dimension: int
    label: str
    tip_mm: float
    unknowns: int
    wall_s: float
    peak_mb: float
    lines: int
    reason: str
    cpu_s: float = math.nan


# Meshes from coarse to fine for each kind of cells.
_MESHES: dict[Cells, tuple[tuple[int, int], ...]] = {
    "tet10": ((1, 8), (1, 12), (2, 12)),
    "hex27": ((1, 8), (1, 12), (2, 12)),
    "tri6": ((1, 0), (2, 0), (4, 0)),
    "quad9": ((1, 0), (2, 0), (4, 0)),
}
_SETTINGS: dict[str, tuple[tuple[Cells, tuple[dict[str, Any], ...]], ...]] = {
    "calculix": (
        ("hex27", ({"first": 0.05}, {"first": 0.25})),
        ("tet10", ({"first": 0.25},)),
        ("quad9", ({"first": 0.05}, {"first": 0.25})),
        ("tri6", ({"first": 0.25},)),
    ),
    "ngsolve": (
        ("hex27", ({"first": 0.25, "predict": False}, {"first": 0.1, "predict": True})),
        ("tet10", ({"first": 0.25, "predict": False}, {"first": 0.1, "predict": True})),
        ("tri6", ({"first": 0.25, "predict": False}, {"first": 0.1, "predict": True}, {"order": 3, "first": 0.1})),
    ),
    "felupe": (
        (
            "hex27",
            (
                {"formulation": "mean", "first": 0.1},
                {"formulation": "mixed", "first": 0.1},
                {"formulation": "mixed", "first": 0.2},
            ),
        ),
        (
            "quad9",
            (
                {"formulation": "mean", "first": 0.1},
                {"formulation": "mixed", "first": 0.1},
                {"formulation": "mixed", "first": 0.2},
            ),
        ),
    ),
    "dolfinx_tutorial": (
        ("hex27", ({"steps": 5}, {"steps": 10})),
        ("tet10", ({"steps": 5}, {"steps": 10})),
        ("tri6", ({"steps": 5}, {"steps": 10})),
    ),
    "dolfinx_tutorial_default_blas": (
        ("hex27", ({"steps": 5},)),
        ("tet10", ({"steps": 5},)),
        ("tri6", ({"steps": 5},)),
    ),
}
PEERS = tuple(_SETTINGS)


def attempts(codes: Sequence[str], dimensions: Sequence[int], levels: int = 3) -> list[Attempt]:
    """All runs of some codes, coarse meshes first; ``levels`` of them."""
    found = []
    for code in codes:
        for cells, settings in _SETTINGS.get(code, ()):
            for meridian, around in _MESHES[cells][:levels]:
                level = Level(cells, meridian, around)
                for options in settings:
                    label = " ".join([level.name, *(f"{k}={v}" for k, v in options.items())])
                    found.append(Attempt(code, 3 if around else 2, label, level, options))
    if "ours" in codes:
        found += _ours()
    found.sort(key=lambda a: (a.dimension, a.level.meridian * max(1, a.level.around) if a.level else 0))
    return [a for a in found if a.dimension in dimensions]


def _ours() -> list[Attempt]:
    """Runs by this program of the scene."""
    found = []
    for tolerance in (1.0, 0.1):
        axis = {"model": "", "rings": "rigid", "element": "hex", "tolerance": tolerance, "ranks": 1}
        found.append(Attempt("ours", 2, f"hex, rigid rings, tolerance {tolerance:g} %", None, axis))
        body = {"model": "full3d", "rings": "rigid", "element": "hex", "tolerance": tolerance}
        for ranks in (2, 1):
            label = f"hex, rigid rings, tolerance {tolerance:g} %, {ranks} rank{'s' * (ranks - 1)}"
            found.append(Attempt("ours", 3, label, None, {**body, "ranks": ranks}))
    tets = {"model": "full3d", "rings": "meshed", "element": "tet", "tolerance": 1.0, "ranks": 2}
    found.append(Attempt("ours", 3, "tet, meshed rings, tolerance 1 %, 2 ranks", None, tets))
    axis = {"model": "", "rings": "meshed", "element": "tet", "tolerance": 1.0, "ranks": 1}
    found.append(Attempt("ours", 2, "tet, meshed rings, tolerance 1 %", None, axis))
    return found


def lines_to_write(path: Path) -> int:
    """Lines of a script or a scene without blank ones, comments and docstrings."""
    text = path.read_text(encoding="utf-8")
    kept = {n for n, line in enumerate(text.splitlines(), start=1) if line.strip() and not line.strip().startswith("#")}
    if path.suffix == ".py":
        for node in ast.walk(ast.parse(text)):
            if (
                isinstance(node, ast.Expr)
                and isinstance(node.value, ast.Constant)
                and isinstance(node.value.value, str)
            ):
                kept -= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return len(kept)


def script_of(code: str) -> Path:
    """The script of a peer."""
    return SCRIPTS / ("dolfinx_tutorial.py" if code.startswith("dolfinx") else f"{code}_bellows.py")


class Study:
    """Makes measurements and keeps them.

    Parameters
    ----------
    scene
        The problem, with meshed rings.
    out
        Folder of the measurements.
    limit_s
        Time limit of a run, s.
    """

    def __init__(self, scene: BellowsScene, scene_text: str, out: Path, limit_s: float = TIME_LIMIT_S) -> None:
        self.scene, self.text, self.out, self.limit_s = scene, scene_text, out, limit_s
        (out / "measured").mkdir(parents=True, exist_ok=True)

    def measure(self, attempt: Attempt) -> Measurement:
        """A measurement, kept or new; one that was stopped earlier than now allowed is made anew."""
        found = self.kept(attempt)
        if found is not None and not self.pending(attempt):
            return found
        made = self._ours(attempt) if attempt.code == "ours" else self._peer(attempt)
        self._file(attempt).write_text(json.dumps(asdict(made), indent=1) + "\n", encoding="utf-8")
        return made

    def pending(self, attempt: Attempt) -> bool:
        """True if it would have to be made."""
        found = self.kept(attempt)
        return found is None or (found.reason.startswith("stopped after") and found.wall_s < self.limit_s)

    def kept(self, attempt: Attempt) -> Measurement | None:
        """A measurement that is there already."""
        path = self._file(attempt)
        return Measurement(**json.loads(path.read_text(encoding="utf-8"))) if path.exists() else None

    def _file(self, attempt: Attempt) -> Path:
        return self.out / "measured" / f"{self._key(attempt)}.json"

    def _key(self, attempt: Attempt) -> str:
        physics = self.scene.model_dump(mode="json", exclude={"name", "ask"})
        codes: list[Any] = [physics, attempt.code, attempt.label, attempt.options]
        if attempt.code == "ours":
            codes.append(provenance.code_hash())
        else:
            files = [script_of(attempt.code), SCRIPTS / "exchange.py", *environment.LISTS]
            codes += [path.read_text(encoding="utf-8") for path in files]
        return hashlib.sha256(json.dumps(codes, sort_keys=True).encode()).hexdigest()[:24]

    def _peer(self, attempt: Attempt) -> Measurement:
        assert attempt.level is not None
        mesh = self.out / "meshes" / f"{attempt.level.name}.npz"
        write_peer_mesh(self.scene, attempt.level, mesh)
        command, variables = peer_command(attempt.code, mesh.absolute(), attempt.options)
        if attempt.code.startswith("dolfinx"):  # its forms into the cache
            coarse = Level(attempt.level.cells, 1, 6 if attempt.dimension == 3 else 0)
            small = self.out / "meshes" / f"{coarse.name}.npz"
            write_peer_mesh(self.scene, coarse, small)
            forms = {**attempt.options, "compile_only": True}
            timed(*peer_command(attempt.code, small.absolute(), forms), self.limit_s)
        before = _cpu_seconds()
        code, wall, output, errors = timed(command, variables, self.limit_s)
        cpu = _cpu_seconds() - before
        lines = lines_to_write(script_of(attempt.code))
        said = last_json(output)
        if said is None:
            reason = _why(code, wall, errors or output)
            said = {"tip_mm": math.nan, "dofs": 0, "peak_mb": math.nan, "reason": reason}
        elif said["reason"]:
            said["reason"] = f"stopped at {1e3 * said['pressure_mpa']:.3g} kPa: {said['reason']}"
            said["tip_mm"] = math.nan
        return Measurement(
            attempt.code,
            attempt.dimension,
            attempt.label,
            said["tip_mm"],
            said["dofs"],
            wall,
            said["peak_mb"],
            lines,
            said["reason"],
            cpu,
        )

    def _ours(self, attempt: Attempt) -> Measurement:
        options = attempt.options
        text = _scene_text(self.text, options)
        ranks = options["ranks"]
        wall, reason, tip, unknowns, peak, cpu = math.nan, "", math.nan, 0, math.nan, math.nan
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "scene.toml")
            scene.write_text(text, encoding="utf-8")
            lines = lines_to_write(scene)
            for trial in ("warm", "timed"):
                out = Path(folder, trial)
                arguments = ["-m", "studies", "solve", str(scene), "--out", str(out)]
                arguments += ["--model", options["model"]] if options["model"] else []
                command = launch.on_ranks(ranks, *arguments)
                before = _cpu_seconds()
                code, wall, output, errors = timed(command, _environment(2 // ranks), self.limit_s)
                cpu = _cpu_seconds() - before
                if code != 0:
                    reason = _why(code, wall, errors or output)
                    break
            if not reason:
                summary = json.loads(Path(out, "summary.json").read_text(encoding="utf-8"))
                last = Path(out, "path.csv").read_text(encoding="utf-8").splitlines()
                tip = float(dict(zip(last[0].split(","), last[-1].split(","), strict=True))["tip_mm"])
                unknowns, peak = summary["dofs"], summary["peak_mb"]
        label = attempt.label
        return Measurement("ours", attempt.dimension, label, tip, unknowns, wall, peak, lines, reason, cpu)


def _scene_text(text: str, options: dict[str, Any]) -> str:
    """The scene with other rings, cells and tolerance."""
    new = []
    for line in text.splitlines():
        key = line.split("=")[0].strip()
        changed = {
            "model": f'model = "{options["rings"]}"',
            "element": f'element = "{options["element"]}"',
            "tolerance_percent": f"tolerance_percent = {options['tolerance']}",
        }
        new.append(changed.get(key, line))
    return "\n".join(new) + "\n"


def _environment(threads: int) -> dict[str, str]:
    """Environment of a child with so many threads."""
    return {**launch.environment(threads), "OMP_NUM_THREADS": str(threads)}


def peer_command(code: str, mesh: Path, options: dict[str, Any]) -> tuple[list[str], dict[str, str]]:
    """Command and environment of a peer's run on two cores."""
    arguments = [str(mesh), json.dumps(options)]
    if code.startswith("dolfinx"):
        variables = _environment(1)
        if code.endswith("default_blas"):
            variables["LD_LIBRARY_PATH"] = str(environment.reference_blas())
        return launch.on_ranks(2, "-m", "studies.peers.dolfinx_tutorial", *arguments), variables
    python = sys.executable if code == "calculix" else str(environment.peers_python())
    return [python, str(script_of(code)), *arguments], _environment(2)


def timed(command: Sequence[str], variables: dict[str, str], limit_s: float) -> tuple[int | None, float, str, str]:
    """Run a command with all its children; exit code (None: stopped at the limit), wall seconds, output, errors."""
    begin = time.perf_counter()
    child = subprocess.Popen(
        list(command),
        cwd=provenance.ROOT,
        env=variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        output, errors = child.communicate(timeout=limit_s)
        return child.returncode, time.perf_counter() - begin, output, errors
    except subprocess.TimeoutExpired:
        _end(child)
        return None, time.perf_counter() - begin, "", ""
    except BaseException:  # interrupted: leave nothing running
        _end(child)
        raise


def _end(child: subprocess.Popen[str]) -> None:
    """End a child and its children."""
    os.killpg(child.pid, signal.SIGTERM)
    try:
        child.communicate(timeout=10.0)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.communicate()


def _cpu_seconds() -> float:
    """Seconds that ended children have spent on cores, theirs included."""
    spent = os.times()
    return spent.children_user + spent.children_system


def last_json(output: str) -> dict[str, Any] | None:
    """The last line of an output that is a JSON object."""
    for line in reversed(output.splitlines()):
        if line.startswith("{"):
            try:
                return dict(json.loads(line))
            except ValueError:
                continue
    return None


def _why(code: int | None, wall_s: float, text: str) -> str:
    """Why a run gave nothing, with the last line it wrote."""
    lines = [line for line in text.splitlines() if line.strip()]
    last = lines[-1][:200] if lines else ""
    return f"stopped after {wall_s:.0f} s" if code is None else f"exit {code}: {last}"


def comparison_rows(
    scene: str, pressure_kpa: float, reference_mm: float, source: str, measured: Iterable[Measurement]
) -> list[Row]:
    """Rows of all measurements, then the ratios."""
    rows: list[Row] = []
    measured = list(measured)
    for m in measured:
        ours = ("axisymmetric", "full3d")[m.dimension - 2]
        model = ours if m.code == "ours" else f"peer_{m.code}"
        status = m.reason or REACHED
        at = (scene, pressure_kpa, model, m.label, status)
        rows.append(_row(at, "tip_mm", "mm", m.tip_mm, reference_mm, source))
        rows.append(_row(at, "wall_s", "s", m.wall_s))
        rows.append(_row(at, "cpu_s", "s", m.cpu_s))
        rows.append(_row(at, "peak_mb", "MB", m.peak_mb))
        rows.append(_row(at, "unknowns", "1", m.unknowns))
        rows.append(_row(at, "lines_to_write", "1", m.lines))
    reached = [m for m in measured if not math.isnan(m.tip_mm)]
    errors = [100.0 * abs(m.tip_mm / reference_mm - 1.0) for m in reached]
    for dimension, name in ((3, "full3d"), (2, "axisymmetric")):
        for kind, found in (("", errors), ("_by_lasting_error", _lasting(reached, errors))):
            points: dict[str, list[Point]] = {}
            for m, error in zip(reached, found, strict=True):
                if m.dimension == dimension:
                    points.setdefault(m.code, []).append(Point(m.wall_s, error))
            every = {code: floored(of, REFERENCE_PERCENT) for code, of in points.items()}
            mine = every.pop("ours", [])
            ratio = ratio_to_fastest(mine, every, ALLOWED_PERCENT)
            quantity = f"time_ratio_{name}_to_fastest_peer{kind}"
            rows.append(row(scene, quantity, "1", pressure_kpa, name, ratio, status=_known(ratio)))
            error, equal = ratio_at_equal_error(mine, every)
            quantity, level = f"time_ratio_{name}_at_equal_error{kind}", f"{error:.3g} %"
            rows.append(row(scene, quantity, "1", pressure_kpa, name, equal, level, status=_known(equal)))
    return rows


def _lasting(measured: Sequence[Measurement], errors: Sequence[float]) -> list[float]:
    """Errors that finer meshes of the same code, cells and settings do not exceed."""
    found = list(errors)
    for family in {_family(m) for m in measured}:
        same = [k for k, m in enumerate(measured) if _family(m) == family]
        same.sort(key=lambda k: measured[k].unknowns)
        for k, error in zip(same, lasting([errors[k] for k in same]), strict=True):
            found[k] = error
    return found


def _family(m: Measurement) -> tuple[str, int, str]:
    """What is alike in runs that differ in their mesh only."""
    if m.code == "ours":
        return m.code, m.dimension, m.label.partition(",")[0]
    mesh, _, settings = m.label.partition(" ")
    return m.code, m.dimension, f"{mesh.partition('-')[0]} {settings}"


def _row(
    at: tuple[str, float, str, str, str],
    quantity: str,
    unit: str,
    value: float,
    reference: float = math.nan,
    source: str = "",
) -> Row:
    scene, pressure, model, level, status = at
    return row(scene, quantity, unit, pressure, model, value, level, math.nan, reference, source, status)


def _known(ratio: float) -> str:
    return "not measured: no run of ours or of a peer" if math.isnan(ratio) else REACHED


def reference_tip(scene: BellowsScene, out: Path) -> tuple[float, float]:
    """The tip on the finest meridian with meshed rings, mm, and how much it differs from the one before, percent."""
    comm = MPI.COMM_WORLD
    tips = []
    for level in REFERENCE_LEVELS:
        run = run_axisymmetric(scene, level, out / f"reference-r{level}", comm, Progress(comm))
        tips.append([state.tip_mm for state in run.path if state.status == "requested"][-1])
    return tips[-1], 100.0 * abs(tips[-1] / tips[-2] - 1.0)


def table(measured: Sequence[Measurement], reference_mm: float) -> str:
    """The measurements as text."""
    heads = f"{'tip mm':>9s} {'error %':>8s} {'wall s':>8s} {'CPU s':>8s} {'MB':>6s} {'unknowns':>8s} lines"
    lines = [f"{'code':30s} {'run':52s} {heads}"]
    for m in sorted(measured, key=lambda m: (m.dimension, m.code, m.wall_s)):
        error = 100.0 * (m.tip_mm / reference_mm - 1.0)
        lines.append(
            f"{m.code:30s} {m.label:52s} {m.tip_mm:9.4f} {error:8.3f} {m.wall_s:8.1f} {m.cpu_s:8.1f} {m.peak_mb:6.0f} "
            f"{m.unknowns:8d} {m.lines:5d} {m.reason}"
        )
    return "\n".join(lines)


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder of the results.")
@click.option("--code", "codes", multiple=True, type=click.Choice([*PEERS, "ours"]), help="Only these; default all.")
@click.option("--dimension", "dimensions", multiple=True, type=click.Choice(["2", "3"]), help="Only these.")
@click.option("--limit", default=TIME_LIMIT_S, show_default=True, help="Time limit of a run, s.")
@click.option("--levels", default=3, show_default=True, help="Meshes of each kind, coarsest first.")
@click.option("--budget", default=math.inf, help="Start no new run after so many seconds; what is kept is still shown.")
def main(
    out: Path, codes: tuple[str, ...], dimensions: tuple[str, ...], limit: float, levels: int, budget: float
) -> None:
    """Measure the peers and this program on scenes/peers/bellows.toml; write rows.csv."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that a run on its way is ended too
    begin = time.perf_counter()
    scene = load_bellows(SCENE)
    study = Study(scene, SCENE.read_text(encoding="utf-8"), out, limit)
    reference, spread = reference_tip(scene, out)
    click.echo(f"reference: {reference:.5f} mm, {spread:.4f} % from the mesh before")
    chosen = codes or (*PEERS, "ours")
    gone = {code: why for code in chosen if (why := environment.missing(code))}
    for code, why in gone.items():
        click.echo(f"{code}: skipped: {why}")
    here = [code for code in chosen if code not in gone]
    stopped: set[tuple[str, str, str]] = set()
    for attempt in attempts(here, [int(d) for d in dimensions] or [2, 3], levels):
        if study.pending(attempt) and time.perf_counter() - begin > budget:
            continue
        kind = (attempt.code, attempt.level.cells if attempt.level else "", json.dumps(attempt.options))
        if attempt.level and kind in stopped:
            click.echo(f"{attempt.code} {attempt.label}: not run, a coarser mesh was stopped at the limit")
            continue
        m = study.measure(attempt)
        if m.reason.startswith("stopped after"):
            stopped.add(kind)
        click.echo(f"{m.code} {m.label}: {m.tip_mm:.4f} mm, {m.wall_s:.1f} s {m.reason}")
    every = attempts((*PEERS, "ours"), [2, 3])
    measured = [found for attempt in every if (found := study.kept(attempt)) is not None]
    source = f"axisymmetric r{REFERENCE_LEVELS[-1]}, meshed rings"
    rows = comparison_rows(scene.name, scene.load.pressure_kpa[-1], reference, source, measured)
    write_rows(out / "rows.csv", rows)
    click.echo(table(measured, reference))
    for entry in rows:
        if entry.quantity.startswith("time_ratio"):
            click.echo(f"{entry.quantity} {entry.level}: {entry.value:.3g}")


if __name__ == "__main__":
    main()
