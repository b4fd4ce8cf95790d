"""Meshes, elements and kinematics: what a field lives on."""
