"""Equations of the closed form's chains: the root as a tube, the side wall in pure shear, element by element.

Numbers of equations: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160. What the chains are is
told in `analytical.bellows.chains`. Every array has the shape of the designs and a last axis for the pressures.
Units: mm, N, MPa.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions, BellowsError
from analytical.bellows.reading import Reading
from analytical.laws.isotropic import Law, Ogden

Difference = Callable[[FloatArray], FloatArray]

# The paper tabulates the root stretch "with an increment of 0.1" (text after eq. (17)).
TABLE_STEP: Final = 0.1

# No elastomer stretches this far; a law that needs more has no stress to give.
_LARGEST_STRETCH = 1e3
# Derivatives are exact to round-off by f(x + ih) = f(x) + ih f'(x) with h^2 below round-off.
_COMPLEX_STEP = 1e-30
# Newton's method doubles its digits: an increment this small leaves its square, below round-off.
_LAST_INCREMENT = 1e-9
# Safeguarded by bisection, so that this many always suffice (2^-60); five to eight are usual.
_MAX_ITERATIONS = 60


@dataclass(frozen=True, eq=False)
class Sizes:
    """Dimensions as float arrays with a last axis for the pressures, mm."""

    shape: tuple[int, ...]
    inner: FloatArray
    outer: FloatArray
    crest: FloatArray
    crest_outer: FloatArray
    side: FloatArray
    half_pitch: FloatArray
    convolutions: FloatArray

    @classmethod
    def of(cls, dimensions: BellowsDimensions | BellowsDesigns) -> Sizes:
        """Arrays from one bellows or many."""

        def column(value: ArrayLike) -> FloatArray:
            return np.asarray(value, dtype=float)[..., None]

        d = dimensions
        inner, wall, crest = column(d.root_radius_mm), column(d.wall_mm), column(d.crest_radius_mm)
        return cls(
            shape=d.shape if isinstance(d, BellowsDesigns) else (),
            inner=inner,
            outer=inner + wall,
            crest=crest,
            crest_outer=crest + wall,
            side=column(d.side_length_mm),
            half_pitch=column(d.half_pitch_mm),
            convolutions=column(d.convolutions),
        )

    @property
    def unfolded(self) -> FloatArray:
        """Outer hoop stretch of the root at full unfolding."""
        return self.crest_outer / self.outer

    def inner_stretch(self, outer_stretch: FloatArray, reading: Reading) -> FloatArray:
        """Hoop stretch of the root's inner surface: eq. (14), exact or linearised."""
        swell = outer_stretch**2 - 1.0
        area = (self.outer / self.inner) ** 2 - 1.0  # 2 epsilon + epsilon^2
        if reading.linear_inner_stretch:
            return np.asarray(outer_stretch + area * swell / (2.0 * outer_stretch))
        return np.asarray(np.sqrt(1.0 + (1.0 + area) * swell))

    def cut(self, reading: Reading, root_stretch: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Area the pressure pushes on and undeformed area of the wall at the reading's cut, mm2."""
        at_root = self.outer**2 - self.inner**2
        at_crest = self.crest_outer**2 - self.crest**2
        if reading.cut == "mixed":
            return math.pi * self.crest**2, math.pi * at_root
        if reading.cut == "crest":
            return math.pi * self.crest**2, math.pi * at_crest
        bore = self.inner * self.inner_stretch(root_stretch, reading)
        if reading.cut == "root":
            return math.pi * bore**2, math.pi * at_root
        mean = (self.crest**2 + self.crest * bore + bore**2) / 3.0
        return math.pi * mean, 0.5 * math.pi * (at_root + at_crest)


def root_difference(law: Law, reading: Reading) -> Difference:
    """sigma_theta - sigma_r of the root at its hoop stretch in plane strain, MPa; eqs. (7) to (10)."""
    if reading.root_derivative == "law" or not isinstance(law, Ogden):
        return lambda s: law.stress_difference(s, 1.0 / s, 1.0)
    mu, power = law.mu_mpa, law.alpha - 1.0
    sign = {"theta": 1.0, "r": -1.0, "z": 0.0}[reading.root_derivative]  # lambda_j = s^sign
    return lambda s: np.asarray(2.0 * mu * s ** (sign * power) * (s**2 - s**-2))


def root_pressure(sizes: Sizes, difference: Difference, reading: Reading, swell: FloatArray) -> FloatArray:
    """Pressure that swells the root's outer surface to lambda_o^2 - 1 = `swell`, MPa, shape of `swell`.

    With r^2 - R^2 = c the same for all particles, d(ln r) = (R / r)^2 d(ln R): eq. (16) without the division by
    1 - lambda^2. In ln R the integrand is analytic up to pi/2 from the real axis, which gives the number of
    Gauss points for round-off. Eq. (14) as printed reaches a little further in than R_i.
    """
    area = (sizes.outer / sizes.inner) ** 2 - 1.0
    depth = 1.0 + area
    if reading.linear_inner_stretch:
        depth = depth + area**2 * swell / (4.0 * (1.0 + swell))
    half = 0.25 * np.log(depth)
    nodes, weights = _gauss(float(np.max(half)))
    pressure = np.zeros(np.broadcast_shapes(np.shape(swell), half.shape))
    for node, weight in zip(nodes, weights, strict=True):
        # (R_o / R)^2 at the point, from the outer surface inwards
        square = 1.0 + swell * np.exp(2.0 * half * (1.0 + node))
        pressure += weight * difference(np.sqrt(square)) / square
    return np.asarray(half * pressure)


def _gauss(half: float) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre rule at round-off for an integrand analytic up to pi/2 from an interval of this half-width."""
    ellipse = 0.5 * math.pi / half
    rate = math.log(ellipse + math.sqrt(1.0 + ellipse**2))
    # error of n points: exp(-2 n rate); one more for the constant
    count = 1 + math.ceil(-math.log(np.finfo(float).eps) / (2.0 * rate))
    return _rule(count)


@functools.cache
def _rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of so many points; kept, since finding them takes longer than using them once."""
    return np.polynomial.legendre.leggauss(count)


def _root_slope(sizes: Sizes, difference: Difference, reading: Reading, swell: FloatArray) -> FloatArray:
    """d(pressure) / d(swell), MPa: the integrand of eq. (16) in the stretch at its two ends."""
    outer = np.sqrt(1.0 + swell)
    inner = sizes.inner_stretch(outer, reading)
    area = (sizes.outer / sizes.inner) ** 2 - 1.0
    if reading.linear_inner_stretch:
        # d(lambda_i) / d(swell) by way of d(lambda_o) / d(swell) = 1 / (2 lambda_o)
        inner_slope = (1.0 + 0.5 * area * (1.0 + outer**-2)) / (2.0 * outer)
    else:
        inner_slope = (1.0 + area) / (2.0 * inner)
    at_inner = difference(inner) / (inner * (inner**2 - 1.0)) * inner_slope
    return np.asarray(at_inner - difference(outer) / (2.0 * outer**2 * swell))


def root_stretch_at(
    sizes: Sizes,
    difference: Difference,
    reading: Reading,
    pressure: FloatArray,
    modulus: float,
    at_crest: FloatArray,
) -> FloatArray:
    """Outer hoop stretch lambda_y of the root, shape of `pressure`; entries past unfolding only if they fold back."""
    wanted = pressure > 0.0
    if not reading.folds_back:
        wanted = wanted & (pressure < at_crest)
    stretch = np.ones(pressure.shape)
    if not np.any(wanted):
        return stretch
    picked = _pick(sizes, wanted)
    aim = pressure[wanted]
    area = (picked.outer / picked.inner) ** 2 - 1.0
    guess = aim / (modulus * area)  # small strains
    top = picked.unfolded**2 - 1.0
    while reading.folds_back and np.any(short := root_pressure(picked, difference, reading, top) < aim):
        top = np.where(short, 2.0 * top + 1.0, top)
        if np.any(top > _LARGEST_STRETCH**2):
            raise BellowsError(f"the root does not reach {1e3 * aim.max():g} kPa at any stretch: lower the pressure")
    swell = _newton(
        lambda q: (
            root_pressure(picked, difference, reading, q) - aim,
            _root_slope(picked, difference, reading, q),
        ),
        np.minimum(guess, 0.9 * top),
        np.zeros_like(aim),
        top,
    )
    stretch[wanted] = np.sqrt(1.0 + swell)
    return stretch


def _pick(sizes: Sizes, mask: BoolArray) -> Sizes:
    """Sizes of the entries under a mask of shape (designs, pressures), flattened."""
    arrays = {name: np.broadcast_to(value, mask.shape)[mask] for name, value in vars(sizes).items() if name != "shape"}
    return Sizes(shape=(), **arrays)


def root_stretch_by_table(sizes: Sizes, difference: Difference, reading: Reading, pressure: FloatArray) -> FloatArray:
    """lambda_y by linear interpolation between stretches 1, 1.1, 1.2, ... as the paper's text tells."""
    highest = float(np.max(pressure))
    stretches, pressures = [1.0], [np.zeros((*sizes.shape, 1))]
    while np.any(pressures[-1] <= highest):
        stretches.append(1.0 + TABLE_STEP * len(stretches))
        swell = np.broadcast_to(np.asarray(stretches[-1] ** 2 - 1.0), (*sizes.shape, 1))
        pressures.append(root_pressure(sizes, difference, reading, swell))
        if stretches[-1] > _LARGEST_STRETCH:
            raise BellowsError(f"the root does not reach {1e3 * highest:g} kPa at any stretch: lower the pressure")
    table = np.concatenate(pressures, axis=-1)
    flat = [
        np.interp(p, row, stretches)
        for p, row in zip(pressure.reshape(-1, pressure.shape[-1]), table.reshape(-1, table.shape[-1]), strict=True)
    ]
    return np.asarray(flat).reshape(pressure.shape)


def wall_stress(law: Law, reading: Reading) -> Difference:
    """Sigma of the side wall at lambda_a in pure shear, MPa; eqs. (19), (20)."""
    if reading.wall_by_20 and isinstance(law, Ogden):
        return lambda s: np.asarray(law.mu_mpa * (s**law.alpha - s**-law.alpha))
    return lambda s: law.stress_difference(s, 1.0 / s, 1.0)


def wall_pull(stress: Difference, reading: Reading, inclined: FloatArray) -> Difference:
    """Axial force of the wall over its undeformed area, MPa; `inclined` is drop / l. Takes complex stretches."""

    def pull(stretch: FloatArray) -> FloatArray:
        value = stress(stretch)
        if reading.wall_on_deformed_area:
            value = value / stretch
        if reading.wall_along_axis:
            square = 1.0 - (inclined / stretch) ** 2
            # below lambda_a l = drop there is no such wall: no axial force
            value = value * np.sqrt(np.where(square.real > 0.0, square, 0.0))
        return value

    return pull


def wall_stretch_at(law: Law, reading: Reading, load: FloatArray, inclined: FloatArray) -> FloatArray:
    """lambda_a at which the wall's pull over its area is `load`, MPa; both of shape (designs, pressures).

    The wall does not shorten under a pressure that is not negative: lambda_a >= 1.
    """
    if isinstance(law, Ogden) and not (reading.wall_on_deformed_area or reading.wall_along_axis):
        # sigma = 2 k alpha sinh(alpha ln(lambda)) is explicit
        factor = law.mu_mpa if reading.wall_by_20 else law.prefactor_mpa * law.alpha
        return np.asarray(np.exp(np.arcsinh(load / (2.0 * factor)) / law.alpha))
    pull = wall_pull(wall_stress(law, reading), reading, inclined)
    # sigma = 4 mu ln(lambda) at small strains; stiffening laws are overtaken from there, so this is often above
    high = np.minimum(load / (4.0 * law.initial_shear_modulus_mpa), 0.5)
    while np.any(short := pull(np.exp(high)) < load):
        high = np.where(short, 1.2 * high + 0.05, high)
        if np.any(high > math.log(_LARGEST_STRETCH)):
            raise BellowsError(
                f"{law} does not reach the wall stress {float(load[short].min()):g} MPa: lower the pressure"
            )

    def evaluate(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        value = pull(np.exp(x + 1j * _COMPLEX_STEP))
        return value.real - load, value.imag / _COMPLEX_STEP

    return np.asarray(np.exp(_newton(evaluate, high, np.zeros(load.shape), high)))


def _newton(
    evaluate: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    guess: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray:
    """Root of an increasing function in [low, high], element by element: Newton, bisecting where it would leave."""
    x = guess
    for _ in range(_MAX_ITERATIONS):
        # below round-off of a stretch the slope is 0 / 0: such an element is bisected
        with np.errstate(divide="ignore", invalid="ignore"):
            value, slope = evaluate(x)
            trial = x - value / slope
        low, high = np.where(value < 0.0, x, low), np.where(value > 0.0, x, high)
        trial = np.where((trial >= low) & (trial <= high), trial, 0.5 * (low + high))
        moved = np.abs(trial - x)
        x = trial
        if np.all(moved <= _LAST_INCREMENT * np.abs(x)):
            break
    return x
