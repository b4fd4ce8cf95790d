"""``bellowsx study NAME``: run a study, write its rows and its page."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click
from mpi4py import MPI

from studies.command.common import check_writable, examples, guarded, say


class _Studies(click.Group):
    """Every study is a command; it is imported when it is asked for, for some take half a second."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        from studies.catalogue import STUDIES

        return list(STUDIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        from studies.catalogue import load_study

        return command_of(load_study(cmd_name)) if cmd_name in self.list_commands(ctx) else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Studies"):
            formatter.write_dl(questions())


def questions() -> list[tuple[str, str]]:
    """Every study and what it asks."""
    from studies.catalogue import STUDIES, load_study

    return [(name, load_study(name).question) for name in STUDIES]


def command_of(study: Any) -> click.Command:
    """The command of a study, with its own options after ``--out``."""

    def call(out: Path | None, **options: Any) -> None:
        from studies.engine import run

        folder = out or Path("results", study.name)
        check_writable(folder)
        sys.exit(guarded(study.name, lambda: run(study, folder, MPI.COMM_WORLD, options)))

    text = f"Folder for runs, rows and report.  [default: results/{study.name}]"
    option = click.Option(["--out"], type=click.Path(path_type=Path), help=text)
    return click.Command(study.name, callback=call, params=[option, *study.options], help=study.question)


@click.group(
    cls=_Studies,
    invoke_without_command=True,
    epilog=examples(
        "bellowsx study --list",
        "bellowsx study vacuum --out results/vacuum",
        "mpirun -n 2 bellowsx study paper --part core",
    ),
)
@click.option("--list", "listed", is_flag=True, help="List the studies and what each asks.")
@click.pass_context
def study(ctx: click.Context, listed: bool) -> None:
    """Run a study: its cases, rows.csv, report.md and report.html.

    What is already there of the same content is not solved again, so an interrupted study goes on where it was. Exit
    code 3: a case stopped early, or something that the study must show is not met.
    """
    if ctx.invoked_subcommand is None:
        say("\n".join(f"{name:22}  {question}" for name, question in questions()) if listed else ctx.get_help())
