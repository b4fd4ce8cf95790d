"""Discretisation errors that a run's own mesh tells."""
