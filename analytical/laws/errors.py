"""What is refused of a material, and how its numbers are checked."""

from __future__ import annotations

import math


class MaterialError(ValueError):
    """A material that cannot be used; the message names the value and the remedy."""


def require_finite(name: str, value: float) -> None:
    """Raise `MaterialError` naming a value that is not a finite number."""
    if not math.isfinite(value):
        raise MaterialError(f"{name} = {value} is not a finite number: give the measured value")


def require_positive(name: str, value: float, remedy: str) -> None:
    """Raise `MaterialError` naming a value that is not positive and finite, with the remedy."""
    require_finite(name, value)
    if value <= 0.0:
        raise MaterialError(f"{name} = {value:g} must be positive: {remedy}")
