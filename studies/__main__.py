"""Command line: ``python -m studies plan | solve | batch | paper | exact | … | report``.

Exit codes: 0 all requested states reached; 2 bad input, nothing run and nothing written; 3 stopped early, partial
results saved.
"""

from __future__ import annotations

import math
import os
import sys
import time
import traceback
from pathlib import Path
from types import TracebackType

import click
from mpi4py import MPI

from analytical.bellows.dimensions import BellowsError
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.command.study import study
from studies.models import session
from studies.models.kinds import AnyPlan, description, plan_for, run
from studies.planning.error_model import ROUNDS, cells_of
from studies.planning.plan import MODELS, SECTOR_LEVELS, Model, make_plan
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import Row
from studies.scene.bellows import Scene
from studies.scene.bodies import AnyScene, is_exact, load_any_scene
from studies.scene.sections import SceneError

# Commands import the studies and what draws their reports themselves: plan and solve then start in half the time.

BAD_INPUT, STOPPED = 2, 3
SMOKE_SCENE = "smoke-t2-ri5"
TITLE = "Silicone bellows actuator: closed form beside axisymmetric beside full 3D"
INTRODUCTION = (
    "Tip elongation of bellows actuators after Heung et al. 2024 (Biomimetics 9, 160, doi "
    "10.3390/biomimetics9030160) under cavity pressure, by the paper's closed-form model and by finite elements."
)


def _out(text: str) -> None:
    """Print on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        click.echo(text)


def _load(paths: tuple[Path, ...], model: Model | None = None) -> list[tuple[AnyScene, str]]:
    """All scenes, or exit with every fault found, also of the requested model; nothing has been written."""
    scenes, faults = [], []
    for path in paths:
        try:
            scenes.append((load_any_scene(path), path.read_text(encoding="utf-8")))
            plan_for(scenes[-1][0], model)
        except SceneError as error:
            faults.append(str(error))
    names = [scene.name for scene, _ in scenes]
    faults += [f"name = {n!r}: two scenes have it; give each its own" for n in {n for n in names if names.count(n) > 1}]
    if faults:
        if MPI.COMM_WORLD.rank == 0:
            click.echo("\n".join(faults), err=True)
        sys.exit(BAD_INPUT)
    return scenes


def _writable(folder: Path) -> None:
    """Exit if the output folder cannot be made or is a file."""
    parent = next(p for p in [folder, *folder.absolute().parents] if p.exists())
    if not parent.is_dir() or not _can_write(parent):
        if MPI.COMM_WORLD.rank == 0:
            click.echo(f"--out {folder}: {parent} is not a folder that can be written to", err=True)
        sys.exit(BAD_INPUT)


def _can_write(folder: Path) -> bool:
    return os.access(folder, os.W_OK | os.X_OK)


SCENE_ARGUMENT = click.argument("scene", type=click.Path(path_type=Path))
SCENES_ARGUMENT = click.argument("scenes", nargs=-1, required=True, type=click.Path(path_type=Path))
OUT_OPTION = click.option(
    "--out", required=True, type=click.Path(path_type=Path), help="Folder for the results; made if missing."
)
MODEL_OPTION = click.option(
    "--model",
    type=click.Choice(MODELS),
    help="Force this model; default: the cheapest whose error can be held within the scene's tolerance.",
)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
def main() -> None:
    """Bellows actuators: closed form beside finite elements, with the error of each."""


@main.command()
@SCENE_ARGUMENT
@MODEL_OPTION
def plan(scene: Path, model: Model | None) -> None:
    """Print what would be solved for SCENE, what is skipped, and why."""
    ((checked, _),) = _load((scene,), model)
    _out(description(checked, model))


@main.command()
@SCENE_ARGUMENT
@OUT_OPTION
@MODEL_OPTION
def solve(scene: Path, out: Path, model: Model | None) -> None:
    """Solve SCENE; writes path.csv, summary.json and rows.csv into the output folder."""
    ((checked, text),) = _load((scene,), model)
    _writable(out)
    sys.exit(_solve(checked, text, plan_for(checked, model), out, MPI.COMM_WORLD))


def _solve(scene: AnyScene, text: str, plan: AnyPlan | None, out: Path, comm: MPI.Comm) -> int:
    """Run a plan (None: every model a body with an exact answer has), print its rows; returns the exit code."""
    progress = Progress(comm)
    try:
        result = run(scene, text, plan, out, comm, progress)
    except (GeometryError, MeshError, SolverError, BellowsError) as error:
        progress.end("")
        if comm.rank == 0:
            click.echo(f"{scene.name}: {error}", err=True)
        return STOPPED
    except OSError as error:
        return _cannot_write(scene.name, error)
    if comm.rank == 0:
        for entry in result.headlines:
            click.echo(f"{scene.name}  {_shown(entry)}")
        if isinstance(result, session.SceneResult) and result.remark:
            click.echo(f"{scene.name}  {result.remark}")
        for note in result.unstable if isinstance(result, session.SceneResult) else ():
            click.echo(f"{scene.name}: {note}", err=True)
        if not result.reached:
            click.echo(f"{scene.name}: stopped early: {result.reason}", err=True)
    return 0 if result.reached else STOPPED


def _cannot_write(what: str, error: OSError) -> int:
    """Disk full, folder gone: only the rank that writes knows, so it ends the others; returns the exit code."""
    click.echo(f"{what}: cannot write the results: {error}", err=True)
    if MPI.COMM_WORLD.size > 1:
        MPI.COMM_WORLD.Abort(STOPPED)
    return STOPPED


def _shown(entry: Row) -> str:
    """A row for the terminal."""
    at = "" if math.isnan(entry.pressure_kpa) else f"{entry.pressure_kpa:g} kPa  "
    name = "" if entry.quantity == "tip_mm" else f"{entry.quantity} "
    if math.isnan(entry.value):
        return f"{at}{entry.model} {entry.level}: {name}{entry.status}"
    spread = "" if math.isnan(entry.uncertainty) else f" +- {entry.uncertainty:.2g}"
    exact = "" if math.isnan(entry.reference) else f" ({entry.error_percent:+.4f} % from {entry.source})"
    digits = ".3f" if entry.quantity == "tip_mm" else ".6g"
    return f"{at}{entry.model} {entry.level}: {name}{entry.value:{digits}}{spread} {entry.unit}{exact if name else ''}"


@main.command()
@SCENES_ARGUMENT
@OUT_OPTION
@MODEL_OPTION
@click.option("--ranks-per-scene", type=click.Choice(["1", "2"]), default="1", show_default=True)
def batch(scenes: tuple[Path, ...], out: Path, model: Model | None, ranks_per_scene: str) -> None:
    """Solve many SCENES, each into a folder of its name; run under mpirun to share them out.

    Finished scenes are not repeated, so an interrupted batch goes on where it was. The exit code is the worst.
    """
    checked = _load(scenes, model)
    _writable(out)
    world, size = MPI.COMM_WORLD, int(ranks_per_scene)
    if world.size % size:
        _out(f"--ranks-per-scene {size}: does not divide the number of ranks, {world.size}")
        sys.exit(BAD_INPUT)
    groups = world.size // size
    mine = world.rank // size
    comm = world.Split(mine, world.rank)
    codes = [
        _solve(scene, text, plan_for(scene, model), out / scene.name, comm) for scene, text in checked[mine::groups]
    ]
    code = max(world.allreduce(max(codes, default=0), op=MPI.MAX), 0)
    if world.rank == 0:
        _out(f"{len(checked)} scenes in {out}")
    sys.exit(code)


@main.command("sweep")
@click.argument("file", type=click.Path(path_type=Path))
@OUT_OPTION
def sweep_command(file: Path, out: Path) -> None:
    """Solve all scenes of a sweep FILE, shared out over the ranks, into one table, sweep.csv.

    Finished scenes are not repeated. Combinations that are no valid scene stay in the table with the reason.
    """
    from studies.models import farm as sweep

    _writable(out)
    try:
        outcome = sweep.run_sweep(file, out, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
    except SceneError as error:
        if MPI.COMM_WORLD.rank == 0:
            click.echo(str(error), err=True)
        sys.exit(BAD_INPUT)
    _out(f"table: {out / 'sweep.csv'}")
    sys.exit(0 if outcome.reached else STOPPED)


@main.command("sweep-study")
@OUT_OPTION
def sweep_study_command(out: Path) -> None:
    """Map the elongation over root radius, wall and convolutions; where the closed form misleads; the report."""
    from studies.sweep import study as sweep_study

    _writable(out)
    outcome = sweep_study.write_sweep_study(out, MPI.COMM_WORLD)
    _out(f"report: {out / 'report.html'}")
    sys.exit(0 if outcome.reached else STOPPED)


@main.command("stability")
@OUT_OPTION
def stability_command(out: Path) -> None:
    """Push bodies along the axes on which solvers break; the exit code is 3 if any cell is a wrong answer."""
    from studies.stability import study as stability_study

    _writable(out)
    report, ok = stability_study.write_study(out, MPI.COMM_WORLD, _out)
    _out(f"report: {report}")
    sys.exit(0 if ok else STOPPED)


@main.command()
@OUT_OPTION
def smoke(out: Path) -> None:
    """Solve two convolutions by every model and write the report: shows in a minute that all works."""
    ((scene, text),) = _load((provenance.ROOT / "scenes" / f"{SMOKE_SCENE}.toml",))
    _writable(out)
    assert isinstance(scene, Scene)
    levels = ROUNDS[cells_of(scene)][:1]
    code = _solve(scene, text, make_plan(scene, "full3d", levels, SECTOR_LEVELS[:1]), out / scene.name, MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        _report(out)
    MPI.COMM_WORLD.barrier()
    sys.exit(code)


@main.command("modes")
@click.argument("scenes", nargs=-1, type=click.Path(path_type=Path))
@OUT_OPTION
@click.option("--full3d", is_flag=True, help="Confirm the first crossing of each of SCENES on the whole body.")
def modes_command(scenes: tuple[Path, ...], out: Path, full3d: bool) -> None:
    """Find where axisymmetric states of SCENES lose stability in m = 0…6 waves round, and draw the modes.

    Without SCENES those of the study, with a ring of exact buckling loads and bodies in full 3D beside them.
    """
    from studies.modes import study as modes_study

    try:
        models = [(modes_study.load_model(p), p.read_text(encoding="utf-8")) for p in scenes or modes_study.STUDY]
    except SceneError as error:
        if MPI.COMM_WORLD.rank == 0:
            click.echo(str(error), err=True)
        sys.exit(BAD_INPUT)
    _writable(out)
    names = [model.scene.name for model, _ in models]
    confirmed = (names if full3d else []) if scenes else list(modes_study.CONFIRMED)
    try:
        results, faults = modes_study.run_study(models, confirmed, not scenes, out, MPI.COMM_WORLD)
    except OSError as error:
        sys.exit(_cannot_write("modes", error))
    for fault in faults if MPI.COMM_WORLD.rank == 0 else []:
        click.echo(fault, err=True)
    rows = [r for result in results for r in result.rows]
    lines = [f"{entry.scene}  {_shown(entry)}" for entry in modes_study.headlines(rows)]
    _out("\n".join([*lines, *modes_study.confirmations(rows)]))
    _out(f"report: {out / 'report.html'}")
    sys.exit(STOPPED if faults or not all(result.reached for result in results) else 0)


@main.command("exact")
@OUT_OPTION
def exact_command(out: Path) -> None:
    """Solve scenes/exact with every model each body has, beside the exact answers; write the report."""
    scenes = _load(tuple(sorted((provenance.ROOT / "scenes" / "exact").glob("*.toml"))))
    _writable(out)
    code = max(_solve(scene, text, None, out / scene.name, MPI.COMM_WORLD) for scene, text in scenes)
    if MPI.COMM_WORLD.rank == 0:
        _report(out)
    MPI.COMM_WORLD.barrier()
    sys.exit(code)


@main.command("verification")
@OUT_OPTION
@click.option(
    "--reuse", type=click.Path(path_type=Path), help="Take over finished runs from this folder, such as results/exact."
)
def verification_command(out: Path, reuse: Path | None) -> None:
    """Make the table of every exact and published problem; the exit code is 3 if one did not reach its loads."""
    from studies.verification import study as verification
    from studies.verification.report import render_verification

    scenes = sorted((provenance.ROOT / "scenes" / "exact").glob("*.toml"))
    _writable(out)
    begin = time.perf_counter()
    found = verification.run_verification(scenes, out, reuse, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
    if MPI.COMM_WORLD.rank == 0:
        _out(f"report: {render_verification(out, found, time.perf_counter() - begin)}")
    MPI.COMM_WORLD.barrier()
    sys.exit(STOPPED if found.stopped else 0)


@main.command("closed-form")
@OUT_OPTION
def closed_form(out: Path) -> None:
    """Write the report of the closed form: chains, corrections, validity, material laws, exact solutions."""
    from studies.closed_form import study as closed_form_study

    _writable(out)
    if MPI.COMM_WORLD.rank == 0:
        click.echo(f"report: {closed_form_study.write_study(out)}")


@main.command("dimensions")
@OUT_OPTION
@click.option("--write-scenes", is_flag=True, help="Also write the scenes of the three sets into scenes/.")
def dimensions_command(out: Path, write_scenes: bool) -> None:
    """Find the dimensions that meet the paper's closed-form numbers and pick three sets of them.

    The exit code is 3 if the picks are not those that analytical/bellows/paper.py records; scenes/ is then left alone.
    """
    from studies.dimensions import scenes as dimension_scenes
    from studies.dimensions import study as dimensions

    _writable(out)
    if MPI.COMM_WORLD.rank != 0:
        return
    picks = dimensions.write_study(out).picks
    click.echo(f"report: {out / 'report.html'}")
    if not picks.as_recorded:
        click.echo(
            f"analytical/bellows/paper.py: FAMILIES is not what the rule picks, {picks.families}: edit it", err=True
        )
        sys.exit(STOPPED)
    if write_scenes:
        for path in dimension_scenes.write_scenes(provenance.ROOT / "scenes", picks.families):
            click.echo(f"scene: {path}")


@main.command("benchmark-closed-form")
@OUT_OPTION
def benchmark_closed_form(out: Path) -> None:
    """Measure the closed form's evaluations per second on one core, and their error."""
    from studies.closed_form import benchmark
    from studies.report.tables import as_text

    _writable(out)
    if MPI.COMM_WORLD.rank == 0:
        found = benchmark.run(out)
        click.echo(f"{benchmark.setting()}\n{as_text(found)}\nrows: {out / 'rows.csv'}")


@main.command("benchmark-solver")
@OUT_OPTION
def benchmark_solver(out: Path) -> None:
    """Measure tangent, factorisation and Newton iteration of a full body, and its path from warm and from cold."""
    from studies.cost import solver_benchmark

    _writable(out)
    ((checked, _),) = _load((provenance.ROOT / "scenes" / "heung-t2-ri5.toml",))
    assert isinstance(checked, Scene)
    _out("\n".join(solver_benchmark.run(checked, out)))


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def report(folder: Path) -> None:
    """Write the report of a study's or batch's FOLDER anew from the results in it."""
    if MPI.COMM_WORLD.rank == 0:
        _report(folder)


def _report(folder: Path) -> None:
    from studies.engine import load_study, render
    from studies.report.scene_page import render_scenes
    from studies.verification.exact import render_exact

    if (folder / "core").is_dir():
        render(load_study("paper"), folder)
        return
    folders = sorted(p.parent for p in folder.glob(f"*/{session.SCENE_FILE}"))
    folders = folders or ([folder] if (folder / session.SCENE_FILE).exists() else [])
    if not folders:
        click.echo(f"{folder}: holds no scene results; run solve, batch or study first", err=True)
        sys.exit(BAD_INPUT)
    exact = [p for p in folders if is_exact(p / session.SCENE_FILE)]
    bellows = [p for p in folders if p not in exact]
    if bellows:
        click.echo(f"report: {render_scenes(folder, TITLE, INTRODUCTION, bellows)}")
    if exact:  # beside bellows, a page of its own
        place = folder / "exact" if bellows else folder
        place.mkdir(exist_ok=True)
        click.echo(f"report: {render_exact(place, exact)}")


main.add_command(study)


def _end_all_ranks(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Report an error nobody expected and end every rank: the others would wait for this one for ever."""
    traceback.print_exception(kind, error, trace)
    sys.stderr.flush()
    MPI.COMM_WORLD.Abort(1)


if __name__ == "__main__":
    if MPI.COMM_WORLD.size > 1:
        sys.excepthook = _end_all_ranks
    main()
