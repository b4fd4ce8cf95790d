"""Command line: ``bellowsx``, which is ``python -m studies``.

Exit codes: 0 all requested states reached; 2 bad input, nothing run and nothing written; 3 stopped early, or something
that a study must show is not met, partial results saved.
"""

from __future__ import annotations

import gc

# Imports leave no garbage to speak of, and to look for it among what they bring is a fifth of a start: now and later.
gc.disable()

import sys
import traceback
from types import TracebackType

import click
from mpi4py import MPI

from studies.command.begin import draw, new, open_
from studies.command.common import examples
from studies.command.look import check, mesh
from studies.command.material import material
from studies.command.report import report
from studies.command.solve import batch, plan, solve
from studies.command.study import study
from studies.command.sweep import sweep

gc.freeze()
gc.enable()

# Commands import the studies and what draws their reports themselves: plan and solve then start in half the time.


@click.group(
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=examples(
        "bellowsx plan scenes/heung-t2-ri5.toml",
        "bellowsx solve scenes/heung-t2-ri5.toml --out results/t2",
        "bellowsx study --list",
    )
    + '\n\nShell completion: eval "$(_BELLOWSX_COMPLETE=bash_source bellowsx)", also zsh_source, fish_source.',
)
def main() -> None:
    """Bellows actuators: closed form beside finite elements, with the error of each."""


for command in (new, draw, plan, solve, report, open_, batch, sweep, study, check, material, mesh):
    main.add_command(command)


def _end_all_ranks(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Report an error nobody expected and end every rank: the others would wait for this one for ever."""
    traceback.print_exception(kind, error, trace)
    sys.stderr.flush()
    MPI.COMM_WORLD.Abort(1)


def run() -> None:
    """Entry point of ``bellowsx``."""
    if MPI.COMM_WORLD.size > 1:
        sys.excepthook = _end_all_ranks
    main(prog_name="bellowsx")


if __name__ == "__main__":
    run()
