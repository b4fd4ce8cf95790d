"""Frictionless contact of axisymmetric walls with themselves and with rigid bodies."""
