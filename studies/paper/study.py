"""The paper study: four actuators by every model, and variants; the largest example of the engine.

Axisymmetric runs are shared out, one rank each; bodies take all ranks. What is there of the same content is used, and
what is there of parts that are not requested is in the report too.
"""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click
from mpi4py import MPI

from analytical.bellows.paper import PRINTED_MASS_G
from studies.engine import FAULTS, Page, Setting, Solved, Study, farm
from studies.models.axisymmetric import run_axisymmetric
from studies.models.finer.start import Coarser
from studies.models.full3d import run_full3d
from studies.models.modes import COUNTED_LEVELS
from studies.models.session import SCENE_FILE, run_plan
from studies.models.tolerance import worst_percent
from studies.paper import bonds, errors, public_constants, sets, times, variants
from studies.paper.acceptance import bars
from studies.paper.audit import coverage, misses
from studies.paper.blocked import blocked_sentences
from studies.paper.cases import AUDIT_BODY_LEVEL, CONTROL_BODY_LEVEL, HIGHEST_KPA, PARTS, Case, Group, case_text
from studies.paper.cases import cases as all_cases
from studies.paper.drawing.pictures import STATES, draw_all
from studies.paper.imperfection import eccentric_core
from studies.paper.results import CaseResult, PaperResults, read_results
from studies.paper.setup import discretisation, silicones, sizes
from studies.paper.statements import mechanism
from studies.paper.statements.claims import CANNOT_TELL, JUDGED_IN, about_their_program, claims, claims_table, in_words
from studies.paper.summary import in_short, notes, silicone_mass, stops
from studies.planning.bellows import plan_bellows
from studies.planning.levels import BODY_MERIDIANS
from studies.report import scene_tables
from studies.report.numbers import duration, number_text, rounded_up
from studies.report.scene_report import SceneReport
from studies.report.tables import facts_table
from studies.results.run_files import SUMMARY_FILE
from studies.results.runs import finished_run, run_hash
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.sections import SceneError

# Cells round the four actuators' bodies: 8 leave 0.09 % at most (docs/decisions.md); more where the answer as moulded
# is not as certain as this, percent.
AROUND: Final[Mapping[Group, tuple[int, ...]]] = {"core": (8, 16), "zigzag": (8,)}
CERTAIN_PERCENT: Final = 0.2
# Cases whose states are counted by harmonic: those that somebody may build, and those that bend sideways.
COUNTED_GROUPS: Final = ("core", "zigzag", "blocked")


def cases(options: Mapping[str, Any]) -> tuple[Case, ...]:
    """Cases of the requested parts."""
    groups: list[Group] = [group for part in options["part"] for group in PARTS[part]]
    return all_cases(*groups)


# --- solving --------------------------------------------------------------------------------


def prepare(chosen: Sequence[Case], at: Setting) -> list[str]:
    """All axisymmetric runs, each content once, shared out over the ranks, the coarsest first; which failed and why."""
    if at.comm.rank == 0:
        write_scenes(at.out, chosen)
    at.comm.barrier()
    alike: dict[str, list[tuple[Case, int]]] = {}
    for case in chosen:
        for level in case.levels:
            content = run_hash(scene_of(at.out, case), "axisymmetric", f"r{level}")
            alike.setdefault(content, []).append((case, level))
    faults: list[str] = []
    for level in sorted({same[0][1] for same in alike.values()}):  # each starts from the states on the one before
        jobs = [same for same in alike.values() if same[0][1] == level]
        at.progress.tell(f"axisymmetric runs on meridian level {level}: {len(jobs)}")
        faults += farm(jobs, at.comm, lambda same: _run_alike(same, at))
    farm([case for case in chosen if case.group == "sets"], at.comm, lambda case: _measure(case, at))
    return [fault for fault in faults if fault]


def _measure(case: Case, at: Setting) -> None:
    """Measure the states of a case, which is kept: of some hundred cases it takes minutes, here on all ranks."""
    read_results(at.out, (case,))


def write_scenes(folder: Path, chosen: Sequence[Case]) -> None:
    """Write the scene file of every case into its folder, where it differs from what is there."""
    for case in chosen:
        file, text = folder / case.name / SCENE_FILE, case_text(case)
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")


def scene_of(folder: Path, case: Case) -> BellowsScene:
    """The scene of a case whose file has been written."""
    return load_bellows(folder / case.name / SCENE_FILE)


def _run_alike(same: Sequence[tuple[Case, int]], at: Setting) -> str:
    """Run the first of axisymmetric runs of one content, and copy it to the others; why it failed, or an empty text."""
    (case, level), *others = same
    place = at.out / case.name / f"axisymmetric-r{level}"
    modes = case.group in COUNTED_GROUPS and level == max(set(case.levels) & set(COUNTED_LEVELS))
    try:
        scene, before = scene_of(at.out, case), _before(case, level, at)
        run = run_axisymmetric(scene, level, place, MPI.COMM_SELF, at.progress, modes, before)
    except FAULTS as error:
        return f"{case.name} r{level}: {error}"
    for other, _ in others:
        copy = at.out / other.name / place.name
        if finished_run(copy, run.summary.content_hash) is None:
            shutil.copytree(place, copy, dirs_exist_ok=True)
    return ""


def _before(case: Case, level: int, at: Setting) -> Coarser | None:
    """The case's run on the next coarser meridian, if it has one; of blocked ones each path is looked at for touch."""
    coarser = [n for n in case.levels if n < level]
    if not coarser or case.group == "blocked":
        return None
    name = f"r{max(coarser)}"
    folder = at.out / case.name / f"axisymmetric-{name}"
    run = finished_run(folder, run_hash(scene_of(at.out, case), "axisymmetric", name))
    return None if run is None else Coarser(run, folder)


def solve(case: Case, at: Setting) -> None:
    """The bodies of a case, on all ranks."""
    if not case.full3d:
        return
    scene, place = scene_of(at.out, case), at.out / case.name
    if case.group in ("audit", "control"):
        level = AUDIT_BODY_LEVEL if case.group == "audit" else CONTROL_BODY_LEVEL
        base = place / f"axisymmetric-r{level.meridian}"
        run_full3d(scene, "full3d", level, base, place / f"full3d-{level.name}", at.comm, at.progress, ())
        return
    for around in AROUND.get(case.group, (0,)):
        plan = plan_bellows(scene, "full3d", (around,) if around else (), every_level=True)
        # what the coarsest meridian lacks is known from the axisymmetric runs, and the same on any body made from it
        plan = dataclasses.replace(plan, body_levels=BODY_MERIDIANS[:1])
        result = run_plan(scene, case_text(case), plan, place, at.comm, at.progress)
        if worst_percent(result.answers) <= CERTAIN_PERCENT:
            break


# --- the page -------------------------------------------------------------------------------


def page(solved: Sequence[Solved[Case, None]], at: Setting) -> Page:
    """What is in the folder of all parts."""
    results = read_results(at.out, all_cases())
    told = left_out(at.out, results)
    shown = content(results, draw_all(at.out, results))
    return Page(results.rows, shown, bars=bars(results), headlines=told)


def left_out(folder: Path, results: PaperResults) -> list[str]:
    """That runs in the folder are of other scenes or code than today's, and so not in the report; a sentence or none.

    Raises
    ------
    SceneError
        If all are: a report of nothing would take the place of one of them.
    """
    there = len(list(folder.glob(f"*/*/*-*/{SUMMARY_FILE}")))
    read = sum(len(case.axisymmetric) + len(case.full3d) for case in results.cases)
    others = f"{there - read} of {there} runs are of other scenes or other code"
    if there and not read:
        raise SceneError(f"{folder}: {others}: nothing is written; `bellowsx study paper` runs them again")
    return [f"{others}: left out of the report; `bellowsx study paper` runs them again"] if there > read else []


def content(results: PaperResults, pictures: Mapping[str, str]) -> dict[str, Any]:
    """What the template shows; pictures are addresses by name, or why there is none."""
    found = claims(results)
    return {
        "results": results,
        "errors": errors,
        "sets": sets,
        "variants": variants,
        "public_constants": public_constants,
        "bonds": bonds,
        "times": times,
        "setup": setup(),
        "in_short": in_short(results),
        "assumptions_percent": number_text(rounded_up(errors.assumptions_percent(results), 1), "g"),
        "imperfection": eccentric_core(results),
        "printed_mass": f"{PRINTED_MASS_G:g}",
        "silicone_mass": silicone_mass(results),
        "highest": f"{HIGHEST_KPA:g}",
        "coverage": coverage(results),
        "misses": misses(results),
        "claims": claims_table(found),
        "claims_in_short": in_words(found),
        "claim_details": {claim.name: claim.details for claim in found if claim.details},
        "contradiction": mechanism.contradiction(results, results.drawn(*JUDGED_IN)),
        "about_their_program": about_their_program(results),
        "cannot_tell": CANNOT_TELL,
        "core_wall": duration(times.seconds(run.summary for case in results.of("core") for run in case.runs)),
        "total_wall": duration(times.seconds(results.summaries)),
        "levels": {case.case.scene: scene_tables.convergence(_report_of(case)) for case in results.of("core", "tets")},
        "stops": stops(results),
        "notes": notes(results),
        "blocked": blocked_sentences(results),
        "runs": facts_table(scene_tables.stamps_of(results.summaries)),
        "pictures": pictures,
        "states": {name.removeprefix(STATES): name for name in pictures if name.startswith(STATES)},
    }


def setup() -> dict[str, Any]:
    """What is solved, for the section of that name."""
    return {
        "dimensions": sizes.dimensions(),
        "sets": sizes.sets(),
        "silicones": silicones.silicones(),
        "makers_modulus": silicones.makers_modulus(),
        "elements": discretisation.elements(),
        "meridians": discretisation.meridians(),
    }


def _report_of(case: CaseResult) -> SceneReport:
    """A case as the tables of scene reports take it."""
    return SceneReport(
        name=case.case.scene,
        title=case.scene.title,
        scene_toml="",
        pressures_kpa=tuple(case.pressures_kpa),
        rows=case.rows,
        runs=tuple(run.summary for run in case.runs),
        paths={},
        fields={},
        notes=(),
    )


STUDY: Final = Study(
    name="paper",
    title="The paper's four actuators: closed form beside finite elements, ANSYS and test",
    question="What is the paper's closed form worth beside finite elements, and which of its statements hold?",
    template="paper/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
    options=(
        click.Option(
            ["--part"],
            type=click.Choice(list(PARTS)),
            multiple=True,
            default=("core", "variants", "sets"),
            show_default=True,
            help="Parts to run: the four actuators, variants, sets of dimensions, finer meshes for its bands.",
        ),
    ),
    prepare=prepare,
)
