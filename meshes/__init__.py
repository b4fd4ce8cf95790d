"""Shapes and meshes: outline, meridian mesh, revolved 3D mesh, quality.

Knows shapes, never physics, and imports nothing of this project. Lengths are in mm, angles in radians.
"""
