"""Give inputs to the command line in a process of its own, one after the other, and keep what becomes of each.

``python -m studies.fuzz.run FILE`` is the child; FILE has its jobs. A segmentation fault, a hang or want of memory ends
the child and not the study: what it was at has then no outcome, and the next child goes on behind it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, cast

from solvers.atomic import write_atomically
from studies import mpi_children
from studies.fuzz.draws import Draw
from studies.fuzz.judge import Ended, Outcome, judged
from studies.fuzz.meshfiles import FILE
from studies.planning.levels import MOST_UNKNOWNS
from studies.results.kept import keep, read_kept

# An axisymmetric run and the one that checks it take seconds of a core, a body that is refined to a tight tolerance
# minutes; so long on the clock means that it hangs: other work may slow this machine down.
LIMIT_S, LIMIT_CLOCK_S = 300.0, 1800.0
# Address space of a child, compilers and gmsh included; a run of this size takes a third of it.
LIMIT_BYTES: Final = 8 * 2**30
# Inputs of a child: it starts in a second, and what one leaves behind may matter to the next.
BATCH: Final = 20
# Up to how many unknowns a mesh is refined for a tolerance here, instead of `studies.planning.levels.MOST_UNKNOWNS`.
FEWER_UNKNOWNS: Final = 30_000
# One process waits for nobody: giving way at each of MUMPS's probes starves it where other work runs.
ALONE: Final = {"OMPI_MCA_mpi_yield_when_idle": "0"}
SENTINEL: Final = "kept.txt"


@dataclass(frozen=True)
class Job:
    """An input, and where its outcome is kept under which key."""

    draw: Draw
    file: Path
    key: str

    @property
    def outcome(self) -> Outcome | None:
        """What is kept."""
        return read_kept(self.file, self.key, Outcome)


# ---- the children's parent ---------------------------------------------------------------------------------


def run_in_children(jobs: Sequence[Job], order: Path, tell: Callable[[Job, Outcome], None]) -> None:
    """Run jobs that have no outcome yet; all have one then.

    Parameters
    ----------
    order
        File that passes them on; removed in the end.
    tell
        Called with each job and its outcome.
    """
    missing = [job for job in jobs if job.outcome is None]
    while missing:
        batch = missing[:BATCH]
        write_atomically(order, pickle.dumps(batch))
        command = [sys.executable, "-m", __name__, str(order)]
        ended = mpi_children.run(command, mpi_children.environment() | ALONE, (LIMIT_CLOCK_S + 10.0) * len(batch))
        order.unlink()
        at = next((job for job in batch if job.outcome is None), None)
        if at is not None:
            keep(at.file, at.key, broken(ended.code, ended.error))
        for job in batch[: batch.index(at) + 1 if at else None]:
            outcome = job.outcome
            assert outcome is not None
            tell(job, outcome)
        missing = [job for job in missing if job.outcome is None]


def broken(code: int, error: str) -> Outcome:
    """The outcome of what a child was at when it ended."""
    if code == -signal.SIGPROF:
        return Outcome("time out", reason=f"not done after {LIMIT_S:g} s of a core", seconds=LIMIT_S)
    if code == -signal.SIGALRM:
        return Outcome("time out", reason=f"not done after {LIMIT_CLOCK_S:g} s", seconds=LIMIT_CLOCK_S)
    name = signal.Signals(-code).name if code < 0 else f"exit {code}"
    return Outcome("crash", reason=f"{name}: {error.strip()[-300:]}")


# ---- the child ---------------------------------------------------------------------------------------------


@contextlib.contextmanager
def _captured(folder: Path) -> Iterator[None]:
    """Let files ``out`` and ``error`` of a folder take what is said, also by C code and by children."""
    with contextlib.ExitStack() as stack:
        for descriptor, name, redirect in (
            (1, "out", contextlib.redirect_stdout),
            (2, "error", contextlib.redirect_stderr),
        ):
            file = stack.enter_context((folder / name).open("a", encoding="utf-8"))
            before = os.dup(descriptor)
            stack.callback(os.close, before)
            stack.callback(os.dup2, before, descriptor)
            os.dup2(file.fileno(), descriptor)
            stack.enter_context(redirect(file))
        yield


def command_line(*arguments: str) -> Ended:
    """The command line with arguments: its exit code, 1 for an error nobody named, and what it said."""
    from studies.__main__ import main

    code: object = 0
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        with _captured(folder), warnings.catch_warnings():  # a warning told once is told again
            try:
                main.main(list(arguments), prog_name="bellowsx")
            except SystemExit as end:
                code = end.code
            except Exception:
                traceback.print_exc()
                code = 1
        out, error = ((folder / name).read_text(encoding="utf-8", errors="replace") for name in ("out", "error"))
    return Ended(code if isinstance(code, int) else 0 if code is None else 1, out, error)


def run_draw(draw: Draw) -> Outcome:
    """Run an input and judge what becomes of it."""
    begin = time.process_time()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        if draw.mesh:
            (folder / FILE).write_bytes(draw.mesh)

        def solve(text: bytes, name: str, command: str = "solve", model: str = "") -> tuple[Ended, Path]:
            out, scene = folder / name, folder / f"{name}.toml"
            scene.write_bytes(text)
            out.mkdir()
            (out / SENTINEL).write_text(name, encoding="utf-8")
            to = () if command == "plan" else ("--out", str(out))
            ended = command_line(command, str(scene), *to, *(("--model", model) if model else ()))
            untouched = [path.name for path in out.iterdir()] == [SENTINEL] and (out / SENTINEL).read_text() == name
            return replace(ended, untouched=untouched), out

        outcome = judged(draw, solve)
    return replace(outcome, seconds=time.process_time() - begin)


def _child(order: Path) -> None:
    """Run the jobs of a file; timers end this process if one takes too long."""
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))
    cast(dict[str, int], MOST_UNKNOWNS).update(dict.fromkeys(MOST_UNKNOWNS, FEWER_UNKNOWNS))
    jobs: list[Job] = pickle.loads(order.read_bytes())
    for job in jobs:
        signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
        signal.setitimer(signal.ITIMER_REAL, LIMIT_CLOCK_S)
        keep(job.file, job.key, run_draw(job.draw))
    for timer in (signal.ITIMER_PROF, signal.ITIMER_REAL):
        signal.setitimer(timer, 0.0)


if __name__ == "__main__":
    _child(Path(sys.argv[1]))
