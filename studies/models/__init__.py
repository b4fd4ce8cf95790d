"""From a scene to converged states: problems, runs, sessions of several levels, many scenes at once."""
