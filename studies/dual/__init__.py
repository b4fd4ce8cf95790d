"""Estimated errors beside true ones."""
