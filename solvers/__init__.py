"""Equilibrium of large-deformation solids with dolfinx and PETSc.

Knows forms, Newton, continuation and output; never what a bellows is. Units: mm, N, MPa (so mJ for energies).
"""

import contextlib

from solvers.installed import stand_in

# The wheel's dolfinx, PETSc and MPI find each other only if this comes before all of them.
with contextlib.suppress(ImportError):
    import dolfinx_solver  # noqa: F401

stand_in()
