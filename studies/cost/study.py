"""The cost study: every cell in a process of its own, one after the other, on a machine that does nothing else.

``python -m studies.cost.study --out results/cost`` measures what is not there yet, once more what other processes
disturbed, and writes rows and report. Each
measurement is kept under a key of its content, so a study that was stopped goes on. A run that compiled a form is
measured again; what compiling takes is measured apart, on one cell per kind, with an empty cache.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import click
import tomlkit

from studies import launch
from studies.cost import cell as cost_cell
from studies.cost import cells as cost_cells
from studies.cost.cells import (
    COMPILED,
    SCENES,
    Cell,
    Measurement,
    all_cells,
    cell_scene,
    large_cells,
    measurement,
    scene_file,
)
from studies.cost.report import FARMED_SCENE, PEER_RATIO, write_cost_report
from studies.cost.rows import farming_rows, measured_rows
from studies.paper.cases import REFERENCE_SCENES
from studies.results import provenance
from studies.results.files import write_text_atomically
from studies.results.rows import Row, read_rows, write_rows

# A cell that takes longer is given up; the largest body needs about a third of it.
LIMIT_S = 900.0
# What is solved side by side, or one after the other: the four actuators at their last pressure.
FARMED = REFERENCE_SCENES
FARMED_MODELS = ("axisymmetric", "full3d")


@dataclass(frozen=True)
class Batch:
    """A batch of scenes on two cores.

    Attributes
    ----------
    model
        Forced model.
    ranks_per_scene
        1: two scenes side by side; 2: one after the other, each on both cores.
    """

    model: str
    ranks_per_scene: int


BATCHES = tuple(Batch(model, ranks) for model in FARMED_MODELS for ranks in (1, 2))


def cell_key(cell: Cell) -> str:
    """Key of a measurement: the cell, its scene, what is measured, the code that computes it and the machine."""
    scene = cell_scene(cell).model_dump(mode="json")
    return _key(asdict(cell), scene, cost_cell.MEASURED_AS)


def batch_key(batch: Batch, texts: Sequence[str]) -> str:
    """As `cell_key`, for a batch."""
    return _key(
        asdict(batch), list(texts), provenance.ROOT.joinpath("studies/models/session.py").read_text(encoding="utf-8")
    )


def _key(*content: object) -> str:
    text = json.dumps([*content, provenance.code_hash(), provenance.machine()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def measure_cell(cell: Cell, limit_s: float = LIMIT_S) -> Measurement:
    """Measure a cell with all its forms compiled, and of some how much longer it takes without.

    A failure is a measurement whose status says why.
    """
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    before = _compiled(cache)
    found = _measure_once(cell, cache, limit_s)
    if _compiled(cache) > before:
        found = _measure_once(cell, cache, limit_s)
    if cell not in COMPILED:
        return found
    with tempfile.TemporaryDirectory(prefix="cost-") as empty:
        cold = _measure_once(cell, Path(empty), limit_s)
    return dataclasses.replace(found, compile_s=cold.wall_s - found.wall_s)


def _compiled(cache: Path) -> int:
    """Number of compiled forms."""
    return len(list(cache.glob("fenics/*.so")))


def _measure_once(cell: Cell, cache: Path, limit_s: float) -> Measurement:
    """One run with a folder of compiled forms."""
    with tempfile.TemporaryDirectory(prefix="cost-") as folder:
        arguments = ("-m", "studies.cost.cell", json.dumps(asdict(cell)), "--out", folder)
        command, environment = launch.on_ranks(cell.ranks, *arguments), launch.environment(cell.threads)
        ended = launch.run(command, environment | {"XDG_CACHE_HOME": str(cache)}, limit_s)
    lines = [line for line in ended.out.splitlines() if line.startswith("{")]
    if ended.code == 0 and lines:
        found = measurement(lines[-1])
        return dataclasses.replace(found, wall_s=ended.wall_s, cpu_s=ended.cpu_s, others_s=ended.others_s)
    said = [line for line in ended.error.splitlines() if line.strip()]
    why = f"failed: stopped after {limit_s:g} s" if ended.code == -1 else f"failed: {said[-1] if said else ended.code}"
    return _costs_only(ended, why)


def measure_batch(batch: Batch, texts: Sequence[str], limit_s: float = LIMIT_S) -> Measurement:
    """Wall and CPU time of a batch of scenes, given as their files' texts."""
    with tempfile.TemporaryDirectory(prefix="cost-") as name:
        files = []
        for k, text in enumerate(texts):
            files.append(Path(name) / f"{k}.toml")
            files[-1].write_text(text, encoding="utf-8")
        arguments = ["-m", "studies", "batch", *map(str, files), "--out", f"{name}/out", "--model", batch.model]
        arguments += ["--ranks-per-scene", str(batch.ranks_per_scene)]
        ended = launch.run(launch.on_ranks(2, *arguments), launch.environment(), limit_s)
    return _costs_only(ended, "reached" if ended.code == 0 else f"failed: exit code {ended.code}")


def _costs_only(ended: launch.Ended, status: str) -> Measurement:
    """Of a process that tells nothing of itself."""
    no = math.nan
    return Measurement(no, no, ended.wall_s, no, ended.cpu_s, no, 0, 0, no, {}, status, ended.others_s)


def batch_texts() -> list[str]:
    """The scene files of a batch, asked for their last pressure, without fields."""
    texts = []
    for name in FARMED:
        document = tomlkit.parse((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
        load, ask = document["load"], document["ask"]
        load["pressure_kpa"] = list(cost_cells.ACTUATOR_KPA)  # type: ignore[index]
        ask["fields"] = False  # type: ignore[index]
        texts.append(tomlkit.dumps(document))
    return texts


class Store:
    """Measurements in a folder, one file per key."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def get(self, key: str) -> Measurement | None:
        """The measurement of a key, if there is one."""
        file = self._folder / f"{key}.json"
        return measurement(file.read_text(encoding="utf-8")) if file.exists() else None

    def take(self, key: str, measure: Callable[[], Measurement]) -> Measurement:
        """A new measurement of a key, kept unless there is one that was disturbed less."""
        found, before = measure(), self.get(key)
        if before is None or not before.others_s / before.wall_s <= found.others_s / found.wall_s:
            write_text_atomically(self._folder / f"{key}.json", found.as_json() + "\n")
        return found


def measure_all(folder: Path, cells: Sequence[Cell], minutes: float, say: Callable[[str], None]) -> bool:
    """Measure what is missing, then once more what was disturbed, for so many minutes; True if nothing is missing."""
    store = Store(folder / "measured")
    end = time.monotonic() + 60.0 * minutes
    texts = batch_texts()
    jobs: list[tuple[str, str, Callable[[], Measurement]]] = [
        (f"{cell.body} {cell.model} {cell.name}", cell_key(cell), partial(measure_cell, cell)) for cell in cells
    ]
    jobs += [
        (f"batch {b.model} {b.ranks_per_scene} ranks each", batch_key(b, texts), partial(measure_batch, b, texts))
        for b in BATCHES
    ]
    kept = {key: store.get(key) for _, key, _ in jobs}
    missing = [job for job in jobs if kept[job[1]] is None]
    wanted = missing + [job for job in jobs if (found := kept[job[1]]) is not None and found.disturbed]
    for number, (name, key, measure) in enumerate(wanted):
        if time.monotonic() > end:
            return number >= len(missing)
        found = store.take(key, measure)
        cost = f"{found.wall_s:.1f} s, {found.peak_mb:.0f} MB"
        note = f" (disturbed: others took {found.others_s:.1f} CPU s)" if found.disturbed else ""
        say(f"{number + 1}/{len(wanted)} {name}: {cost}, {found.value:.6g} mm, {found.status}{note}")
    return True


def peer_rows(file: Path) -> list[Row]:
    """Of the peer study's rows, the other programs' and the ratios to them; none if it has not been run."""
    if not file.exists():
        return []
    return [r for r in read_rows(file) if r.model.startswith("peer_") or r.quantity.startswith(PEER_RATIO)]


def model_rows(file: Path) -> list[Row]:
    """Rows of the error model's check; none if it has not been run."""
    return read_rows(file) if file.exists() else []


def study_rows(folder: Path, cells: Sequence[Cell]) -> list[Row]:
    """Rows of all that has been measured with the present content."""
    store = Store(folder / "measured")
    measured = {cell: found for cell in cells if (found := store.get(cell_key(cell))) is not None}
    texts = batch_texts()
    batches = {b: found for b in BATCHES if (found := store.get(batch_key(b, texts))) is not None}
    rows = measured_rows(measured)
    for batch, found in batches.items():
        rows += farming_rows(FARMED_SCENE, batch.model, batch.ranks_per_scene, found)
    return rows


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for measurements and report.")
@click.option(
    "--peers", default="results/peers/rows.csv", type=click.Path(path_type=Path), help="Rows of the peer study."
)
@click.option(
    "--model", default="results/error-model/rows.csv", type=click.Path(path_type=Path), help="Of the error fit."
)
@click.option("--minutes", default=math.inf, help="Start no more cells after so long; the same command goes on.")
@click.option("--large", is_flag=True, help="Also the largest bodies that fit 24 GB; they take minutes each.")
@click.option("--body", multiple=True, help="Only cells of this scene file below scenes/, for instance exact/tube.")
def main(out: Path, peers: Path, model: Path, minutes: float, large: bool, body: tuple[str, ...]) -> None:
    """Measure the cost and error of every model, element, mesh and way of stepping; write rows and report."""
    unwanted = () if large else large_cells()
    cells = [cell for cell in all_cells() if (not body or cell.body in body) and cell not in unwanted]
    for name in {cell.body for cell in cells}:
        if not scene_file(name).exists():
            raise click.UsageError(f"{scene_file(name)} is missing")
    done = measure_all(out, cells, minutes, click.echo)
    write_rows(out / "rows.csv", [*study_rows(out, all_cells()), *peer_rows(peers), *model_rows(model)])
    click.echo(f"report: {write_cost_report(out)}")
    if not done:
        click.echo("not complete: run the same command again")
        sys.exit(3)


if __name__ == "__main__":
    main()
