"""Stored energies, their laws and loads as weak forms."""
