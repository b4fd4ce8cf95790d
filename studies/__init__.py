"""Scenes, plans, runs, comparison rows, reports and the command line."""

import os

# A process that no launcher has started talks to nobody: looking for networks and a daemon would cost Open MPI 0.3 s.
if not any(name.startswith(("OMPI_COMM_WORLD", "PMI", "PRTE_LAUNCHED")) for name in os.environ):
    os.environ["OMPI_MCA_ess_singleton_isolated"] = "1"
    os.environ["OMPI_MCA_pml"] = "ob1"
