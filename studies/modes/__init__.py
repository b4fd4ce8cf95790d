"""Modes that break the symmetry: from which pressure on, in which shape."""
