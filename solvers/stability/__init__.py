"""Stability of axisymmetric states: against which harmonics of the angle, in which mode, and where along a path."""
