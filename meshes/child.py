"""The environment of a child process that is none of this process's MPI ranks."""

import os

# Variables by which Open MPI, PRRTE, PMIx, and MPICH's Hydra tell a process that it is a rank.
_OF_A_RANK = ("OMPI_", "PMIX_", "PRTE_", "PMI_", "HYDI_", "HYDRA_", "MPI_LOCAL", "MPICH_")


def environment() -> dict[str, str]:
    """Environment without what makes this process a rank: a child of one must not believe that it is one too."""
    return {name: value for name, value in os.environ.items() if not name.startswith(_OF_A_RANK)}
