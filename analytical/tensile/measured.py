"""What was measured in homogeneous states: stretch and nominal stress by test."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.exact.homogeneous import MODES, Mode
from analytical.laws.stability import LARGEST_STRETCH

# Points of a test at least; two constants through one point are no fit.
LEAST_POINTS: Final = 3


class MeasuredError(ValueError):
    """Measured values that no law can be fitted to; the message names them and the remedy."""


@dataclass(frozen=True)
class MaterialTest:
    """One test of an incompressible specimen.

    Parameters
    ----------
    mode
        One of `analytical.exact.homogeneous.MODES`.
    stretch
        Stretch along which it is pulled, shape (n,); the undeformed state says nothing and may be left out.
    nominal_mpa
        Force per undeformed area, shape (n,), MPa.
    weight
        Of each point's squared relative error, shape (n,); empty for 1. Those of the squared
        stresses make errors absolute.

    Raises
    ------
    MeasuredError
        With the value and what is wanted.
    """

    mode: Mode
    stretch: FloatArray
    nominal_mpa: FloatArray
    weight: FloatArray = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        if self.mode not in MODES:
            raise MeasuredError(f"mode = {self.mode!r}: say one of {', '.join(MODES)}")
        if self.stretch.shape != self.nominal_mpa.shape or self.stretch.ndim != 1:
            raise MeasuredError(f"{len(self.stretch)} stretches and {len(self.nominal_mpa)} stresses: one for each")
        if len(self.stretch) < LEAST_POINTS:
            raise MeasuredError(f"{len(self.stretch)} points of a {self.mode} test: give at least {LEAST_POINTS}")
        impossible = ~((self.stretch > 0.0) & (self.stretch < LARGEST_STRETCH))
        if impossible.any():
            raise MeasuredError(
                f"stretch = {self.stretch[impossible][0]:g}: must be above 0 and below {LARGEST_STRETCH:g}, 1 is "
                "undeformed; was a strain given in percent?"
            )
        if not np.isfinite(self.nominal_mpa).all():
            raise MeasuredError("a stress is not a finite number")
        wrong = (self.stretch - 1.0) * self.nominal_mpa < 0.0
        if wrong.any():
            k = int(np.flatnonzero(wrong)[0])
            raise MeasuredError(
                f"stress {self.nominal_mpa[k]:g} MPa at stretch {self.stretch[k]:g}: pulled is above stretch 1 with a "
                "positive stress, pushed below with a negative one; zero the curve first"
            )
        if not len(self.weight):
            object.__setattr__(self, "weight", np.ones(len(self.stretch)))
        if self.weight.shape != self.stretch.shape or not (self.weight > 0.0).all():
            raise MeasuredError("weights must be above 0, one for each point")

    @property
    def loaded(self) -> MaterialTest:
        """The test without points that carry nothing, of which no relative error can be told."""
        return self.where((self.nominal_mpa != 0.0) & (self.stretch != 1.0))

    def where(self, kept: BoolArray) -> MaterialTest:
        """The test with some of its points, shape (n,)."""
        return MaterialTest(self.mode, self.stretch[kept], self.nominal_mpa[kept], self.weight[kept])
