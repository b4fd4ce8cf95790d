"""Closed forms, material laws and exact solutions for soft bellows actuators: numpy and scipy only.

Nothing in this package may import dolfinx, PETSc or gmsh; it has to answer on a machine without a solver.

materials : hyperelastic laws, ring materials and their constants (the only place that holds them)
bellows   : dimensions of a bellows actuator, one or many at once
chains    : the closed-form model of Heung et al. 2024 as printed, misprints mended, statics mended
            (its equations are in chain_equations)
mends     : every departure from the print, and what it is worth
bellows_loads : pressure for an elongation, force at a held tip
validity  : the chain with one assumption replaced: root, side wall, tip
paper     : what that paper prints, and the dimensions inferred from it
fit       : all dimensions that meet the printed closed form, and the rule that picks three sets of them

Exact solutions, for any isotropic incompressible law:

homogeneous  : uniaxial, equibiaxial and pure shear
tube, sphere : thick walls under pressure; ends of the tube free, capped or held; the sphere's limit point
compressible : the same with a finite bulk modulus
torsion, flexure : a twisted and stretched cylinder, a block bent into a sector
ring         : buckling of a ring under follower and dead external pressure
cube         : Rivlin's cube under equal dead tensions

Units: mm, N, MPa (so mJ for energy); names carry any other unit.
"""
