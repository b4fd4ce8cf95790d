"""Newton's method under a held pressure, volume or plane."""
