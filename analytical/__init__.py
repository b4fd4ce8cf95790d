"""Closed forms, material laws and exact solutions for soft bellows actuators: numpy and scipy only.

Nothing in this package may import dolfinx, PETSc or gmsh; it has to answer on a machine without a solver.

laws/    : what a material is: stored energies, stiff solids, and their constants (the only place that holds them)
exact/   : problems with an exact solution, for any isotropic incompressible law
bellows/ : the closed form of Heung et al. 2024, its corrections, and the dimensions inferred with it
arrays   : array types

`exact` and `bellows` know `laws`, not each other; `laws` knows neither. Units: mm, N, MPa (so mJ for energy); names
carry any other unit.
"""
