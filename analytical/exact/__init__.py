"""Exact solutions for any isotropic incompressible law.

homogeneous      : uniaxial, equibiaxial and pure shear
tube, sphere     : thick walls under pressure; ends of the tube free, capped or held; the sphere's limit point
compressible     : the same with a finite bulk modulus
torsion, flexure : a twisted and stretched cylinder, a block bent into a sector
ring, elastica   : buckling of a ring under follower and dead external pressure; a thin ring bent beyond it
cube             : Rivlin's cube under equal dead tensions
two_spheres      : two spheres on one cavity, whose volume turns back
search           : the first solution on the way from rest
"""
