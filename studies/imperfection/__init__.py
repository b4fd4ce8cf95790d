"""Actuators whose moulding core sat off the axis."""
