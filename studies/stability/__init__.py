"""The stress test: cells along the axes on which solvers break."""
