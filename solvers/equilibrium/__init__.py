"""Newton's method, what it holds while it looks for equilibrium, and forces on what holds a body there."""
