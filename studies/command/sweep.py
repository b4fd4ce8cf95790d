"""``bellowsx sweep``: all scenes of a sweep file."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import OUT, STOPPED, check_writable, examples, guarded, say


@click.command(
    epilog=examples(
        "bellowsx sweep sweeps/heung-map.toml --out results/map",
        "mpirun -n 2 bellowsx sweep sweeps/heung-map.toml --out results/map",
    )
)
@click.argument("file", type=click.Path(path_type=Path))
@OUT
def sweep(file: Path, out: Path) -> None:
    """Solve all scenes of a sweep FILE, shared out over the ranks, into one table, sweep.csv.

    Finished scenes are not repeated. Combinations that are no valid scene stay in the table with the reason.
    """
    from studies.progress import Progress
    from studies.sweep import farm

    check_writable(out)

    def work() -> int:
        outcome = farm.run_sweep(file, out, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
        say(f"table: {out / 'sweep.csv'}")
        if outcome.failed or outcome.stopped:
            say(
                f"{outcome.failed} of {outcome.scenes} scenes failed, {outcome.stopped} stopped early: the column "
                "status says why",
                err=True,
            )
        if outcome.not_met:
            say(
                f"{outcome.not_met} of {outcome.scenes} scenes do not hold the tolerance: the column status says what "
                "was reached; set ask.tolerance_percent to the largest of it",
                err=True,
            )
        return 0 if outcome.reached else STOPPED

    sys.exit(guarded(str(file), work))
