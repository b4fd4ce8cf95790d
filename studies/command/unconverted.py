"""Commands of studies that are not on the engine yet."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import OUT, STOPPED, cannot_write, check_writable
from studies.progress import Progress


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


COMMANDS = (paper,)
