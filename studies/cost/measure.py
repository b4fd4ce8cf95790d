"""Measures cells and batches of the cost study, each in a process of its own, and keeps what came out.

A run that compiled a form is measured again; what compiling takes is measured apart, on one cell per kind, with an
empty cache.
"""

from __future__ import annotations

import json
import math
import os
import tempfile
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Final

from studies import mpi_children
from studies.cost.cases import COMPILED, Batch, Cell, batch_texts, cell_scene
from studies.results import provenance
from studies.results.kept import content_key, keep, read_kept

# To be raised when something else is measured, so that what was measured before is not taken for it.
MEASURED_AS: Final = 1
# Share of its wall time in which other processes may compute without disturbing a measurement.
QUIET: Final = 0.1
# A cell that takes longer is given up; the largest body needs about a third of it.
LIMIT_S: Final = 900.0


@dataclass(frozen=True)
class Measurement:
    """What one cell cost, and its answer.

    Attributes
    ----------
    value, pressure_kpa
        The tip's (bellows) or the bore's (tube) displacement at the highest requested pressure, mm; NaN if not reached.
    wall_s, work_s
        From start to end of the process, and without start, imports and end.
    cpu_s
        User and system time of all ranks, start and imports included.
    peak_mb
        Peak resident memory of all ranks.
    compile_s
        How much longer the same run takes with an empty cache of compiled forms; NaN where that was not measured.
    split_s
        Wall seconds by activity; ``axisymmetric start`` is the whole of the run that a warm body starts from.
    status
        ``reached``, or why not.
    others_s
        CPU seconds that other processes, or other machines on the same host, took meanwhile; NaN if not known.
    """

    value: float
    pressure_kpa: float
    wall_s: float
    work_s: float
    cpu_s: float
    peak_mb: float
    unknowns: float
    factorisations: float
    compile_s: float
    split_s: dict[str, float] = field(hash=False)
    status: str
    others_s: float = math.nan

    @property
    def disturbed(self) -> bool:
        """True unless others are known to have left the machine to it."""
        return not self.others_s <= QUIET * self.wall_s


def key_of(case: Cell | Batch) -> str:
    """Key of a measurement: the case, its scenes, what is measured, the code that computes it and the machine."""
    by = (provenance.code_hash(), provenance.machine())
    if isinstance(case, Cell):
        return content_key(case, cell_scene(case).model_dump(mode="json"), MEASURED_AS, *by)
    return content_key(case, batch_texts(), *by, sources=[provenance.ROOT / "studies" / "models" / "session.py"])


def kept_measurement(case: Cell | Batch, folder: Path) -> Measurement | None:
    """What has been measured of the present content."""
    key = key_of(case)
    return read_kept(folder / f"{key}.json", key, Measurement)


def measure(case: Cell | Batch) -> Measurement:
    """A new measurement; a failure is one whose status says why."""
    return measure_cell(case) if isinstance(case, Cell) else measure_batch(case)


def keep_quieter(case: Cell | Batch, found: Measurement, folder: Path) -> None:
    """Keep a measurement unless there is one that was disturbed less."""
    before = kept_measurement(case, folder)
    if before is None or not before.others_s / before.wall_s <= found.others_s / found.wall_s:
        key = key_of(case)
        keep(folder / f"{key}.json", key, found)


def measure_cell(cell: Cell) -> Measurement:
    """Measure a cell with all its forms compiled, and of some how much longer it takes without."""
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    before = _compiled(cache)
    found = _measure_once(cell, cache)
    if _compiled(cache) > before:
        found = _measure_once(cell, cache)
    if cell not in COMPILED:
        return found
    with tempfile.TemporaryDirectory(prefix="cost-") as empty:
        return replace(found, compile_s=_measure_once(cell, Path(empty)).wall_s - found.wall_s)


def _compiled(cache: Path) -> int:
    """Number of compiled forms."""
    return len(list(cache.glob("fenics/*.so")))


def _measure_once(cell: Cell, cache: Path) -> Measurement:
    """One run with a folder of compiled forms."""
    with tempfile.TemporaryDirectory(prefix="cost-") as folder:
        arguments = ("-m", "studies.cost.cell", json.dumps(asdict(cell)), "--out", folder)
        environment = mpi_children.environment(cell.threads) | {"XDG_CACHE_HOME": str(cache)}
        ended = mpi_children.run(mpi_children.on_ranks(cell.ranks, *arguments), environment, LIMIT_S)
    if ended.code == 0 and ended.said:
        return replace(Measurement(**ended.said), wall_s=ended.wall_s, cpu_s=ended.cpu_s, others_s=ended.others_s)
    why = f"stopped after {LIMIT_S:g} s" if ended.code == -1 else ended.last_line or str(ended.code)
    return _costs_only(ended, f"failed: {why}")


def measure_batch(batch: Batch) -> Measurement:
    """Wall and CPU time of a batch."""
    with tempfile.TemporaryDirectory(prefix="cost-") as name:
        files = [Path(name, f"{k}.toml") for k, _ in enumerate(batch_texts())]
        for file, text in zip(files, batch_texts(), strict=True):
            file.write_text(text, encoding="utf-8")
        arguments = ["-m", "studies", "batch", *map(str, files), "--out", f"{name}/out", "--model", batch.model]
        arguments += ["--ranks-per-scene", str(batch.ranks_per_scene)]
        ended = mpi_children.run(mpi_children.on_ranks(2, *arguments), mpi_children.environment(), LIMIT_S)
    return _costs_only(ended, "reached" if ended.code == 0 else f"failed: exit code {ended.code}")


def _costs_only(ended: mpi_children.Ended, status: str) -> Measurement:
    """Of a process that tells nothing of itself."""
    no = math.nan
    return Measurement(no, no, ended.wall_s, no, ended.cpu_s, no, 0, 0, no, {}, status, ended.others_s)
