"""Closed forms, material laws and exact solutions for soft bellows actuators: numpy and scipy only.

Nothing in this package may import dolfinx, PETSc or gmsh; it has to answer on a machine without a solver.

materials : hyperelastic laws, ring materials and their constants (the only place that holds them)
bellows   : the closed-form model of Heung et al. 2024, misprints mended
paper     : what that paper prints, and the dimensions inferred from it
tube      : the exact thick-walled tube under pressure

Units: mm, N, MPa (so mJ for energy); names carry any other unit.
"""
