"""Paths of converged states: steps, arc length, warm starts, where stability is lost, branches, why they end."""
