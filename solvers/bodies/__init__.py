"""Rigid bodies bonded to the solid."""
