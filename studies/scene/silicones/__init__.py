"""Silicones: by name, and by tensile tests that a law is fitted to."""
