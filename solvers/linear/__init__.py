"""Linear solves: factorisations with their count of negative pivots, and iterations."""
