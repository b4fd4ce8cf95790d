"""Child processes on MPI ranks of their own: the launcher, its settings, their environment."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from meshes import child

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
