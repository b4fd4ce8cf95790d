"""Children on ranks of their own: a rank's variables do not reach them, the launcher is the stack's."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from meshes.by_gmsh import child
from studies import mpi_children


@pytest.mark.parametrize(
    "name", ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PRTE_LAUNCHED", "PMI_RANK", "HYDI_CONTROL_FD", "MPI_LOCALRANKID"]
)
def test_what_makes_a_rank_stays_behind(monkeypatch, name: str) -> None:
    monkeypatch.setenv(name, "0")
    monkeypatch.setenv("KEPT", "yes")
    for environment in (child.environment(), mpi_children.environment()):
        assert name not in environment and environment["KEPT"] == "yes"


def test_threads_and_launcher(monkeypatch, tmp_path: Path) -> None:
    assert mpi_children.environment(3)["OPENBLAS_NUM_THREADS"] == "3"
    assert mpi_children.on_ranks(1, "-m", "x") == [sys.executable, "-m", "x"]
    own = tmp_path / "mpirun"
    own.write_text("#!/bin/sh\n", encoding="utf-8")
    own.chmod(0o755)
    monkeypatch.setenv("MPIRUN", str(own))
    assert mpi_children.on_ranks(2, "a") == [str(own), "-n", "2", sys.executable, "a"]
    # beside this Python is the launcher of the MPI that it was compiled with
    monkeypatch.delenv("MPIRUN")
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert mpi_children.launcher() == str(own)


def test_two_ranks_know_each_other(python) -> None:
    code = "from mpi4py import MPI; n = MPI.COMM_WORLD.allreduce(1); print(n) if MPI.COMM_WORLD.rank == 0 else None"
    assert python.run(2, "-c", code).split() == ["2"]


def test_a_run_over_its_limit_is_stopped_with_its_children() -> None:
    ended = mpi_children.run(["sh", "-c", "sleep 60 & sleep 60"], {}, 0.5)
    assert ended.code == -1 and ended.wall_s < 15.0


def test_what_a_child_said_last() -> None:
    ended = mpi_children.run(["sh", "-c", "echo noise; echo '{\"tip_mm\": 1}'; echo '{done'; echo no >&2"], {}, 10.0)
    assert ended.code == 0 and ended.said == {"tip_mm": 1} and ended.last_line == "no"
    ended = mpi_children.run(["sh", "-c", "echo nothing"], {}, 10.0)
    assert ended.said is None and ended.last_line == "nothing"


def test_a_run_leaves_nothing_behind_when_it_is_terminated(tmp_path: Path) -> None:
    code = (
        "from studies import mpi_children; mpi_children.run(['sh', '-c', 'sleep 60 & echo $! > {0}; wait'], {{}}, 60.0)"
    )
    file = tmp_path / "pid"
    parent = subprocess.Popen([sys.executable, "-c", code.format(file)], cwd=mpi_children.ROOT)
    while not (file.exists() and file.read_text()):
        assert parent.poll() is None  # it would never write the file
        time.sleep(0.05)
    parent.terminate()
    assert parent.wait(30.0) == 128 + signal.SIGTERM
    status = Path(f"/proc/{file.read_text().strip()}/status")  # gone, or nobody has asked for its end yet
    assert not status.exists() or "Z (zombie)" in status.read_text()
