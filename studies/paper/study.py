"""The paper study: all its cases run into one folder, and read back from it.

Axisymmetric runs are shared out, one rank each; bodies take all ranks. What is there of the same content is used.
"""

from __future__ import annotations

import dataclasses
import shutil
import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from analytical.bellows import chains, loads
from analytical.bellows.paper import actuators
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.models.axisymmetric import run_axisymmetric
from studies.models.full3d import run_full3d
from studies.models.session import SCENE_FILE, SceneResult, read_scene_folder, run_plan
from studies.paper.cases import AUDIT_BODY_LEVEL, Case, audit_cases, case_text, cases
from studies.paper.numbers import PRESSURES_KPA
from studies.paper.report import write_paper_report
from studies.paper.results import CaseResult, PaperResults
from studies.planning.bellows import SECTOR_LEVELS, plan_bellows
from studies.planning.levels import BODY_MERIDIANS
from studies.progress import Progress
from studies.report.drawn import key_of
from studies.results import measured_rows, measures, provenance, runs, uncertainty
from studies.results.files import write_text_atomically
from studies.results.rows import Row, read_rows, write_rows
from studies.results.runs import finished_run, run_hash
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows

SCENES = provenance.ROOT / "scenes"

# Cells round the four actuators' bodies: they leave 0.05 % at most there (docs/decisions.md), less than the error model
# takes for any bellows.
CORE_AROUND = (8,)
# Cases whose states are counted by harmonic: those that somebody may build, and those that bend sideways.
COUNTED_GROUPS = ("core", "blocked")


def write_scenes(folder: Path, cases: Sequence[Case]) -> None:
    """Write the scene file of every case into its folder, where it differs from what is there."""
    for case in cases:
        file, text = folder / case.place / SCENE_FILE, case_text(case, SCENES)
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")


def run_cases(folder: Path, cases: Sequence[Case], comm: MPI.Comm, progress: Progress) -> list[str]:
    """Run cases; every rank calls.

    Returns
    -------
    list of str
        Which runs failed and why, on every rank. A path that ends early is no failure but a result.
    """
    if comm.rank == 0:
        write_scenes(folder, cases)
    comm.barrier()
    scenes = {case: load_bellows(folder / case.place / SCENE_FILE) for case in cases}
    faults = _run_axisymmetric(folder, scenes, comm, progress)
    for case, scene in scenes.items():
        if case.full3d:
            faults += _run_bodies(folder / case.place, case, scene, comm, progress)
    return faults


def _run_axisymmetric(folder: Path, scenes: dict[Case, BellowsScene], comm: MPI.Comm, progress: Progress) -> list[str]:
    """All axisymmetric runs, each content once, shared out over the ranks, the longest first."""
    alike: dict[str, list[tuple[Case, int]]] = {}
    for case in scenes:
        for level in case.levels:
            alike.setdefault(run_hash(scenes[case], "axisymmetric", f"r{level}"), []).append((case, level))
    jobs = sorted(alike.values(), key=lambda same: -same[0][1])
    faults = []
    for (case, level), *same in jobs[comm.rank :: comm.size]:
        place = folder / case.place / f"axisymmetric-r{level}"
        try:
            modes = case.group in COUNTED_GROUPS
            run = run_axisymmetric(scenes[case], level, place, MPI.COMM_SELF, progress, modes)
        except (GeometryError, MeshError, SolverError) as error:
            faults.append(f"{case.place} r{level}: {error}")
            continue
        for other, _ in same:
            copy = folder / other.place / place.name
            if finished_run(copy, run.summary.content_hash) is None:
                shutil.copytree(place, copy, dirs_exist_ok=True)
    return [fault for of_rank in comm.allgather(faults) for fault in of_rank]


def _run_bodies(place: Path, case: Case, scene: BellowsScene, comm: MPI.Comm, progress: Progress) -> list[str]:
    """The bodies of a case, on all ranks."""
    try:
        if case.group == "audit":
            level = AUDIT_BODY_LEVEL
            base = place / f"axisymmetric-r{level.meridian}"
            run_full3d(scene, "full3d", level, base, place / f"full3d-{level.name}", comm, progress, ())
        else:
            sectors = SECTOR_LEVELS if case.group == "core" else ()
            around = CORE_AROUND if case.group == "core" else ()
            plan = plan_bellows(scene, "full3d", around, sectors, every_level=True)
            if case.group != "core":  # beside those, for other elements or a count of modes; finer takes up to 10 GB
                plan = dataclasses.replace(plan, body_levels=BODY_MERIDIANS[:1])
            run_plan(scene, case_text(case, SCENES), plan, place, comm, progress)
    except (GeometryError, MeshError, SolverError) as error:
        return [f"{case.place} full3d: {error}"]
    return []


def read_results(folder: Path, cases: Sequence[Case]) -> PaperResults:
    """What has been run of cases with their present content."""
    found = []
    for case in cases:
        place = folder / case.place
        if (place / SCENE_FILE).exists():
            result = read_scene_folder(load_bellows(place / SCENE_FILE), place, current=True)
            found.append(CaseResult(case, place, result, _measured(place, result)))
    return PaperResults(tuple(found))


def _measured(place: Path, result: SceneResult[BellowsScene]) -> tuple[Row, ...]:
    """The measured rows of a case; kept beside its runs, for measuring some hundred states takes a minute."""
    hashes = [run.summary.content_hash for run in result.axisymmetric]
    key = key_of(hashes, code=[measures, measured_rows, chains, loads, runs, uncertainty])
    rows_file, key_file = place / "measured.csv", place / "measured.key"
    if not (rows_file.exists() and key_file.exists() and key_file.read_text(encoding="utf-8") == key):
        write_rows(rows_file, measured_rows.measured_rows(result.scene, result.axisymmetric, place))
        write_text_atomically(key_file, key)
    return tuple(read_rows(rows_file))


def write_report(folder: Path) -> tuple[PaperResults, Path]:
    """Write the report of all that has been run into a folder; what was found, and the page."""
    begin = time.perf_counter()
    for actuator in actuators():
        for chain in (chains.closed_form, chains.closed_form_printed, chains.closed_form_balanced):
            chain(actuator.dimensions, actuator.law, PRESSURES_KPA)
    seconds = {"closed form": time.perf_counter() - begin}
    results = read_results(folder, (*cases(), *audit_cases()))
    seconds["total"] = sum(run.summary.time_s["total"] for case in results.cases for run in case.result.runs)
    facts = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    return results, write_paper_report(folder, results, facts, seconds)
