"""Paths whose volume turns back, and branches beyond buckling."""
