"""Parts of a problem's equations: unknowns and supports, load, terms beside the solid, the sparse tangent, checks."""
