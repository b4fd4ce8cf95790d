"""Equilibrium of large-deformation solids with dolfinx and PETSc.

Knows forms, Newton, continuation and output; never what a bellows is. Units: mm, N, MPa (so mJ for energies).
"""
