"""Finer meshes start from states of coarser ones: points found on a mesh, states carried over, runs that begin so."""
