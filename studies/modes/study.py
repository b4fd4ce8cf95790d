"""The modes study: in which harmonics axisymmetric states are unstable, from which pressure on, in which shapes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from mpi4py import MPI

from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from solvers.stability.modes import WAVES
from studies.models.modes import COUNTED_LEVELS, FoundCrossing, counts_of, read_crossings
from studies.models.modes_model import ModesModel
from studies.modes.full3d import confirm_rows
from studies.modes.pictures import draw_mode
from studies.modes.ring import ring_rows
from studies.progress import Progress
from studies.results import provenance
from studies.results.body_rows import CORNER_ORDER
from studies.results.rows import Row, is_reached, row, write_rows
from studies.results.runs import MERIDIAN_ORDER, Run, stopped_text
from studies.results.uncertainty import UNKNOWN, Convergence, from_two
from studies.scene.bodies import BodyScene
from studies.scene.files import load_scene

ROWS_FILE, TABLE_FILE = "rows.csv", "crossings.csv"
_SCENES = provenance.ROOT / "scenes"
# The paper's four actuators, two of them with their tips held, a shorter one, and a clamped tube.
STUDY: Final = (
    *(_SCENES / f"heung-{name}.toml" for name in ("t1-ri5", "t1-ri7", "t2-ri5", "t2-ri7")),
    _SCENES / "blocked-t2-ri5.toml",
    *(_SCENES / "modes" / f"{name}.toml" for name in ("blocked-t1-ri5", "blocked-short", "tube-clamped")),
    *sorted((_SCENES / "modes").glob("vacuum-*.toml")),  # to where their folds touch
)
# Of these the first crossing is confirmed on the whole body in 3D.
CONFIRMED: Final = ("blocked-short", "tube-clamped")


@dataclass(frozen=True)
class SceneModes:
    """What was found of a scene.

    Attributes
    ----------
    model
        The scene.
    runs
        Its counted runs, coarsest first.
    crossings
        By run.
    rows
        Comparison rows.
    pictures
        Of the finest run's critical modes, by harmonic, relative to the study's folder.
    """

    model: ModesModel
    runs: tuple[Run, ...]
    crossings: tuple[tuple[FoundCrossing, ...], ...]
    rows: tuple[Row, ...]
    pictures: dict[int, str]

    @property
    def reached(self) -> bool:
        """True if every run reached every requested pressure and was counted there."""
        return all(
            run.summary.status == "reached" and all(row.unstable_by_m for row in run.requested) for run in self.runs
        )


def load_model(path: Path) -> ModesModel:
    """Read a scene whose modes can be counted.

    Raises
    ------
    SceneError
        With what is wrong; nothing has been solved or written.
    """
    model = ModesModel(load_scene(path))
    model.check()
    return model


def scene_modes(model: ModesModel, text: str, out: Path, confirm: bool, progress: Progress) -> SceneModes:
    """Run a scene on the counted meridians, on this rank alone, into a folder of its name.

    Parameters
    ----------
    model, text
        The scene and its file's text.
    out
        The study's folder.
    confirm
        True to solve the whole body in 3D on both sides of the first crossing.
    """
    folder = out / model.scene.name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    places = [folder / f"axisymmetric-r{level}" for level in COUNTED_LEVELS]
    runs = [model.run(level, place, progress) for level, place in zip(COUNTED_LEVELS, places, strict=True)]
    counted = [any(row.unstable_by_m for row in run.path) for run in runs]
    crossings = [tuple(read_crossings(place)) if known else () for place, known in zip(places, counted, strict=True)]
    rows = [*_count_rows(model, runs), *_crossing_rows(model, runs, crossings)]
    if confirm and crossings[0]:
        rows += confirm_rows(model, places[0], crossings[0][0])
    pictures = {}
    for crossing in crossings[-1]:
        name = f"pictures/{model.scene.name}-m{crossing.waves}.png"
        if fault := draw_mode(out / name, model, COUNTED_LEVELS[-1], places[-1], crossing):
            progress.warn(f"{model.scene.name}: no picture of m = {crossing.waves}: {fault}")
        else:
            pictures[crossing.waves] = name
    return SceneModes(model, tuple(runs), tuple(crossings), tuple(rows), pictures)


def _count_rows(model: ModesModel, runs: Sequence[Run]) -> list[Row]:
    """Unstable modes of each harmonic at each requested pressure."""
    rows = []
    for pressure in model.scene.loads_kpa:
        for run in runs:
            here = run.at(pressure)
            counts = counts_of(here) if here else ()
            for m in WAVES:
                value, status = math.nan, stopped_text(run, ".6g")
                if counts:
                    value, status = float(counts[m]), "reached"
                name = f"unstable_m{m}"
                rows.append(
                    row(model.scene.name, name, "1", pressure, "axisymmetric", value, run.summary.level, status=status)
                )
    return rows


def _crossing_rows(model: ModesModel, runs: Sequence[Run], crossings: Sequence[Sequence[FoundCrossing]]) -> list[Row]:
    """Where each harmonic is lost, and the volume, elongation and force there; or that none is."""
    rows = []
    waves = sorted({c.waves for found in crossings for c in found})
    order = CORNER_ORDER if isinstance(model.scene, BodyScene) else MERIDIAN_ORDER
    for m in waves:
        of_m = [next((c for c in found if c.waves == m), None) for found in crossings]
        for name, unit in (("kpa", "kPa"), ("volume_ratio", "1"), ("tip_mm", "mm"), ("tip_force_n", "N")):
            values = [math.nan if c is None else _value(c, name) for c in of_m]
            if all(math.isnan(v) for v in values):
                continue
            spread = _spread(values, order)
            for run, crossing, value in zip(runs, of_m, values, strict=True):
                within = crossing.within_kpa if crossing is not None and name == "kpa" else 0.0
                status = "reached" if crossing is not None else _none_up_to(run)
                rows.append(
                    row(model.scene.name, f"crossing_m{m}_{name}", unit, math.nan, "axisymmetric", value,
                        run.summary.level, spread.uncertainty(value) + within, status=status)
                )  # fmt: skip
    if not waves:
        for run in runs:
            rows.append(
                row(model.scene.name, "crossing_kpa", "kPa", math.nan, "axisymmetric", math.nan, run.summary.level,
                    status=_none_up_to(run))
            )  # fmt: skip
    return rows


def _value(crossing: FoundCrossing, name: str) -> float:
    return {
        "kpa": crossing.pressure_kpa,
        "volume_ratio": crossing.volume_ratio,
        "tip_mm": crossing.tip_mm,
        "tip_force_n": crossing.tip_force_n,
    }[name]


def _spread(values: Sequence[float], order: float) -> Convergence:
    """What the counted meridians say of the discretisation's error."""
    if any(math.isnan(v) for v in values):
        return UNKNOWN
    return from_two([1.0 / level for level in COUNTED_LEVELS], values, order)


def _none_up_to(run: Run) -> str:
    asked = [r.pressure_kpa for r in run.path if r.unstable_by_m]
    return f"none up to {max(asked, key=abs):.6g} kPa" if asked else "not counted"


def run_study(
    models: Sequence[tuple[ModesModel, str]], confirmed: Sequence[str], with_ring: bool, out: Path, comm: MPI.Comm
) -> tuple[list[SceneModes], list[str]]:
    """Count the modes of scenes, shared out over the ranks, and write rows.csv and crossings.csv; every rank calls.

    Parameters
    ----------
    models
        Scenes with their files' texts.
    confirmed
        Names of those that are confirmed in full 3D.
    with_ring
        True to buckle the ring with exact loads too.
    out
        Where to.

    Returns
    -------
    tuple of list
        What was found of the scenes, and which failed and why; on every rank.
    """
    progress = Progress(comm)
    mine: list[tuple[int, SceneModes]] = []
    faults = []
    for k, (model, text) in list(enumerate(models))[comm.rank :: comm.size]:
        try:
            mine.append((k, scene_modes(model, text, out, model.scene.name in confirmed, progress)))
        except (GeometryError, MeshError, SolverError) as error:
            faults.append(f"{model.scene.name}: {error}")
    pairs = [pair for part in comm.allgather(mine) for pair in part]
    faults = [fault for part in comm.allgather(faults) for fault in part]
    results = [result for _, result in sorted(pairs, key=lambda pair: pair[0])]
    if comm.rank == 0:
        rows = [entry for result in results for entry in result.rows]
        rows += ring_rows() if with_ring else []
        write_rows(out / ROWS_FILE, rows)
        write_rows(out / TABLE_FILE, [entry for entry in rows if entry.quantity.startswith("crossing")])
        from studies.modes.report import write_report

        write_report(out, results, rows)
    comm.barrier()
    return results, faults


def headlines(rows: Sequence[Row]) -> list[Row]:
    """Rows for a terminal: the pressures of crossings."""
    return [r for r in rows if r.quantity.startswith("crossing") and r.unit == "kPa"]


def confirmations(rows: Sequence[Row]) -> list[str]:
    """Lines for a terminal: counts on whole bodies beside those of the harmonics."""
    return [
        f"{r.scene}  {r.pressure_kpa:.5g} kPa  full3d {r.level}: {r.value:g} unstable, by harmonics {r.reference:g}"
        + ("" if is_reached(r) else f" ({r.status})")
        for r in rows
        if r.model == "full3d"
    ]
