"""Child processes on MPI ranks of their own: the launcher, its settings, their environment, running one to its end."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshes.by_gmsh import child

ROOT = Path(__file__).resolve().parents[1]

# Open MPI 4, and 5 (PRTE), as in the Makefile: may run as root, with more ranks than cores, not tied to a core, talking
# through memory. Ranks that wait give way: there may be more of them than cores.
SETTINGS = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_tcp_if_include": "lo",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


def launcher() -> str | None:
    """Path of mpirun: the environment's MPIRUN, the one beside this Python (the wheel's own MPI), or the system's."""
    beside = Path(sys.executable).with_name("mpirun")
    return shutil.which(os.environ.get("MPIRUN") or (str(beside) if beside.exists() else "mpirun"))


def on_ranks(ranks: int, *arguments: str) -> list[str]:
    """Command that runs this Python with arguments on so many ranks."""
    command = [sys.executable, *arguments]
    return command if ranks == 1 else [launcher() or "mpirun", "-n", str(ranks), *command]


def environment(threads: int = 1) -> dict[str, str]:
    """Environment of such a child, with so many BLAS threads on each rank."""
    return {**child.environment(), **SETTINGS, "OPENBLAS_NUM_THREADS": str(threads)}


@dataclass(frozen=True)
class Ended:
    """A process that has ended: exit code, standard output, standard error, wall and CPU seconds, and others' CPU."""

    code: int
    out: str
    error: str
    wall_s: float
    cpu_s: float
    others_s: float

    @property
    def said(self) -> dict[str, Any] | None:
        """The last line of its output that is a JSON object."""
        for line in reversed(self.out.splitlines()):
            with contextlib.suppress(ValueError):
                if line.startswith("{"):
                    return dict(json.loads(line))
        return None

    @property
    def last_line(self) -> str:
        """The last line of what it complained of, or else of its output."""
        lines = [line for line in (self.error or self.out).splitlines() if line.strip()]
        return lines[-1] if lines else ""


def until(unit_s: float) -> Callable[[object, object, float], float]:
    """Callback of an option that says how long new children are started: until when, by `time.monotonic`."""
    return lambda context, parameter, length: time.monotonic() + unit_s * length


def busy_s() -> float:
    """CPU seconds that this machine has been busy since its start, those taken by its host included (Linux).

    Without those of niced processes, which give way; the study itself is not to be niced.
    """
    # user, nice, system, idle, iowait, irq, softirq, steal
    ticks = [int(n) for n in Path("/proc/stat").read_text(encoding="ascii").split("\n", 1)[0].split()[1:9]]
    return (sum(ticks) - ticks[1] - ticks[3] - ticks[4]) / os.sysconf("SC_CLK_TCK")


def run(command: Sequence[str], environment: dict[str, str], limit_s: float) -> Ended:
    """Run a command with all its children to its end, or to the limit, which is exit code -1.

    CPU time is that of all processes it has waited for. Nothing is left running, also if this process is interrupted
    or terminated.
    """
    previous = signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as error:
        before, busy, begin = os.times(), busy_s(), time.perf_counter()
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=out, stderr=error, start_new_session=True)
        late = threading.Event()

        def stop() -> None:
            if process.poll() is None:
                late.set()
                _end(process)

        # to wait with a limit would be to look every 50 ms, which is much of a short run
        timer = threading.Timer(min(limit_s, threading.TIMEOUT_MAX), stop)
        try:
            timer.start()
            code = process.wait()
        finally:
            timer.cancel()
            _end(process)
            if timer.is_alive():
                timer.join()
            signal.signal(signal.SIGTERM, previous)
        wall, after = time.perf_counter() - begin, os.times()
        cpu = after.children_user + after.children_system - before.children_user - before.children_system
        others = max(0.0, busy_s() - busy - cpu)
        out.seek(0)
        error.seek(0)
        return Ended(-1 if late.is_set() else code, out.read(), error.read(), wall, cpu, others)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End what is left of a process and its children; mpirun ends its ranks."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGTERM)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10.0)
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
