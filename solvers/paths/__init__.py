"""Paths of converged states: steps, arc length, warm starts, branches, checkpoints, why they end."""
