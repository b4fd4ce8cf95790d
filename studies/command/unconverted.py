"""Commands of studies that are not on the engine yet."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import BAD_INPUT, OUT, STOPPED, cannot_write, check_writable, load_scenes, say
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import Row
from studies.scene.bellows import BellowsScene
from studies.scene.sections import SceneError


def shown(entry: Row) -> str:
    """A row for the terminal."""
    at = "" if math.isnan(entry.pressure_kpa) else f"{entry.pressure_kpa:g} kPa  "
    name = "" if entry.quantity == "tip_mm" else f"{entry.quantity} "
    if math.isnan(entry.value):
        return f"{at}{entry.model} {entry.level}: {name}{entry.status}"
    spread = "" if math.isnan(entry.uncertainty) else f" +- {entry.uncertainty:.2g}"
    exact = "" if math.isnan(entry.reference) else f" ({entry.error_percent:+.4f} % from {entry.source})"
    digits = ".3f" if entry.quantity == "tip_mm" else ".6g"
    return f"{at}{entry.model} {entry.level}: {name}{entry.value:{digits}}{spread} {entry.unit}{exact if name else ''}"


@click.command()
@OUT
@click.option("--core", is_flag=True, help="Leave out the variants, each of which is a question of its own.")
@click.option("--audit", is_flag=True, help="Also run finer meshes than the study's, to see whether its bands hold.")
def paper(out: Path, core: bool, audit: bool) -> None:
    """Run the paper study: four actuators by every model, variants, and the report about the paper's numbers.

    Also in the report: whatever of the rest is in the output folder already. The exit code is 3 if a run of the four
    actuators did not reach every requested pressure.
    """
    check_writable(out)
    try:
        code = _paper(out, core, audit)
    except OSError as error:
        code = cannot_write("paper study", error)
    sys.exit(code)


def _paper(out: Path, core: bool, audit: bool) -> int:
    """Run the paper study and write its report; returns the exit code."""
    from studies.paper import cases as paper_cases
    from studies.paper import study as paper_study

    comm, progress = MPI.COMM_WORLD, Progress(MPI.COMM_WORLD)
    chosen = [case for case in paper_cases.cases() if case.group == "core" or not core]
    faults = paper_study.run_cases(out, chosen, comm, progress)
    if audit:
        faults += paper_study.run_cases(out, paper_cases.audit_cases(), comm, progress)
    code = 0
    if comm.rank == 0:
        for fault in faults:
            click.echo(fault, err=True)
        results, report = paper_study.write_report(out)
        stopped = [case for case in results.of("core") if not case.result.reached]
        for case in stopped:
            click.echo(f"{case.case.name}: stopped early: {case.result.reason}", err=True)
        code = STOPPED if faults or stopped else 0
        click.echo(f"report: {report}")
    return int(comm.bcast(code))


@click.command("stability")
@OUT
def stability_command(out: Path) -> None:
    """Push bodies along the axes on which solvers break; the exit code is 3 if any cell is a wrong answer."""
    from studies.stability import study as stability_study

    check_writable(out)
    report, ok = stability_study.write_study(out, MPI.COMM_WORLD, say)
    say(f"report: {report}")
    sys.exit(0 if ok else STOPPED)


@click.command("modes")
@click.argument("scenes", nargs=-1, type=click.Path(path_type=Path))
@OUT
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
    check_writable(out)
    names = [model.scene.name for model, _ in models]
    confirmed = (names if full3d else []) if scenes else list(modes_study.CONFIRMED)
    try:
        results, faults = modes_study.run_study(models, confirmed, not scenes, out, MPI.COMM_WORLD)
    except OSError as error:
        sys.exit(cannot_write("modes", error))
    for fault in faults if MPI.COMM_WORLD.rank == 0 else []:
        click.echo(fault, err=True)
    rows = [r for result in results for r in result.rows]
    lines = [f"{entry.scene}  {shown(entry)}" for entry in modes_study.headlines(rows)]
    say("\n".join([*lines, *modes_study.confirmations(rows)]))
    say(f"report: {out / 'report.html'}")
    sys.exit(STOPPED if faults or not all(result.reached for result in results) else 0)


@click.command("closed-form")
@OUT
def closed_form(out: Path) -> None:
    """Write the report of the closed form: chains, corrections, validity, material laws, exact solutions."""
    from studies.closed_form import study as closed_form_study

    check_writable(out)
    if MPI.COMM_WORLD.rank == 0:
        click.echo(f"report: {closed_form_study.write_study(out)}")


@click.command("dimensions")
@OUT
@click.option("--write-scenes", is_flag=True, help="Also write the scenes of the three sets into scenes/.")
def dimensions_command(out: Path, write_scenes: bool) -> None:
    """Find the dimensions that meet the paper's closed-form numbers and pick three sets of them.

    The exit code is 3 if the picks are not those that analytical/bellows/paper.py records; scenes/ is then left alone.
    """
    from studies.dimensions import scenes as dimension_scenes
    from studies.dimensions import study as dimensions

    check_writable(out)
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


@click.command("benchmark-closed-form")
@OUT
def benchmark_closed_form(out: Path) -> None:
    """Measure the closed form's evaluations per second on one core, and their error."""
    from studies.closed_form import benchmark
    from studies.report.tables import as_text

    check_writable(out)
    if MPI.COMM_WORLD.rank == 0:
        found = benchmark.run(out)
        click.echo(f"{benchmark.setting()}\n{as_text(found)}\nrows: {out / 'rows.csv'}")


@click.command("benchmark-solver")
@OUT
def benchmark_solver(out: Path) -> None:
    """Measure tangent, factorisation and Newton iteration of a full body, and its path from warm and from cold."""
    from studies.cost import solver_benchmark

    check_writable(out)
    ((checked, _),) = load_scenes((provenance.ROOT / "scenes" / "heung-t2-ri5.toml",))
    assert isinstance(checked, BellowsScene)
    say("\n".join(solver_benchmark.run(checked, out)))


COMMANDS = (
    paper,
    stability_command,
    modes_command,
    closed_form,
    dimensions_command,
    benchmark_closed_form,
    benchmark_solver,
)
