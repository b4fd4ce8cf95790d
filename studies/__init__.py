"""Scenes, plans, runs, comparison rows, reports and the command line."""

import os

# A process that no launcher has started talks to nobody: looking for networks and a daemon would cost Open MPI 0.3 s.
if not any(name.startswith(("OMPI_COMM_WORLD", "PMI", "PRTE_LAUNCHED")) for name in os.environ):
    os.environ["OMPI_MCA_ess_singleton_isolated"] = "1"
    os.environ["OMPI_MCA_pml"] = "ob1"

# OpenBLAS reads these when NumPy or PETSc loads it. Its threads wait for their next work in a loop, for 2^26 cycles
# unless told otherwise: while MUMPS worked on fronts too small to share, a core was lost to that. Beside other ranks
# they would fight for the cores.
os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "14")
if any(os.environ.get(name, "1") != "1" for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")):
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
