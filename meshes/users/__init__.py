"""A user's mesh: what its file holds, whether it is one sound body, its named surfaces, and its refinement."""
