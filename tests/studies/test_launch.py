"""Children on ranks of their own: a rank's variables do not reach them, the launcher is the stack's."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from meshes import child
from studies import launch


@pytest.mark.parametrize(
    "name", ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PRTE_LAUNCHED", "PMI_RANK", "HYDI_CONTROL_FD", "MPI_LOCALRANKID"]
)
def test_what_makes_a_rank_stays_behind(monkeypatch, name: str) -> None:
    monkeypatch.setenv(name, "0")
    monkeypatch.setenv("KEPT", "yes")
    for environment in (child.environment(), launch.environment()):
        assert name not in environment and environment["KEPT"] == "yes"


def test_threads_and_launcher(monkeypatch, tmp_path: Path) -> None:
    assert launch.environment(3)["OPENBLAS_NUM_THREADS"] == "3"
    assert launch.on_ranks(1, "-m", "x") == [sys.executable, "-m", "x"]
    own = tmp_path / "mpirun"
    own.write_text("#!/bin/sh\n", encoding="utf-8")
    own.chmod(0o755)
    monkeypatch.setenv("MPIRUN", str(own))
    assert launch.on_ranks(2, "a") == [str(own), "-n", "2", sys.executable, "a"]
    # beside this Python is the launcher of the MPI that it was compiled with
    monkeypatch.delenv("MPIRUN")
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert launch.launcher() == str(own)


def test_two_ranks_know_each_other(python) -> None:
    code = "from mpi4py import MPI; n = MPI.COMM_WORLD.allreduce(1); print(n) if MPI.COMM_WORLD.rank == 0 else None"
    assert python.run(2, "-c", code).split() == ["2"]
