"""Discretisation error of a state, with its sign, from the mesh that it was found on."""
