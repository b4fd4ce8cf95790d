"""Dimensions that the paper does not print, inferred from the closed-form elongations that it does.

Source of the numbers: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 4.

Four printed numbers (the closed-form column at 20 kPa; ANSYS and experiment are never used) stand against R_p, the
second R_i, e, n, which of two silicones each actuator has, and which number of a pair belongs to which R_i. That is
about five unknowns: many sets of dimensions fit, and that a set fits says nothing for the model.

members : sets of dimensions as arrays, their elongations and errors; the chains they can be inferred with
search  : all sets of a grid that fit
refine  : single ones brought to their smallest error
masses  : what an actuator of a set weighs, against the printed mass
picks   : the rule that picks three sets to work with

Units: mm, N, MPa; pressures in kPa, elongations compared in cm as printed, masses in g.
"""
