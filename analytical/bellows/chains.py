"""Closed form of a bellows actuator with rigid crest rings (Heung et al. 2024), in three chains.

Source: Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3, equations (1) to (23).

The chain, per pressure P:

1. Every root is a plane-strain tube from R_i to R_i + t (eqs. (4) to (17)). P gives its outer hoop stretch
   lambda_y through P = int (sigma_theta - sigma_r) / r dr.
2. At lambda_y (R_i + t) = R_p + t the root has reached the crest: fully unfolded, lambda_y stays there.
3. The side wall, in pure shear along its length, balances the thrust (eqs. (1), (18) to (22)).
4. Half pitch a = sqrt((lambda_a l)^2 - ((R_p + t) - lambda_y (R_i + t))^2); elongation 2 n (a - e), eq. (23).

`closed_form_printed` evaluates the print as it stands, with |P| for the pressure whose sign is wrong in it.
`closed_form` has the misprints corrected and keeps the modelling: it is the chain that has to meet the printed
closed-form numbers, and the one the dimensions are inferred with. `closed_form_balanced` corrects the statics of
step 3 too. What separates them is listed item by item in `analytical.bellows.corrections`.

Step 3 is one equation, with the unfolded part of it chosen by `Reading`:

    sigma(lambda_a) [1 / lambda_a] [a / b] A = P S

The print has sigma(lambda_a) ((R_i + t)^2 - R_i^2) = P R_p^2: the Cauchy stress on the undeformed area
(no 1 / lambda_a), cos(theta) = a / b on both sides (so that it drops out, and the geometry with it), thrust S at
the crest but wall area A at the root. The balanced chain has both factors, and A and S of one cut. By default
the cut is the mean of all cuts, which is the virtual work of the model's own motion (straight side walls,
lambda_a uniform): A = pi t (R_i + R_p + t), S = pi (R_p^2 + R_p r + r^2) / 3, r the root's deformed inner radius.

Left as in the paper in all three: the wall's pull on the root, the hoop strain of the wall, its bending, and
the stretch of the crest under the ring.

Units: mm, N, MPa inside; pressures at the interface in kPa, as the names say.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytical.arrays import FloatArray
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions, BellowsError
from analytical.bellows.equations import (
    Sizes,
    root_difference,
    root_pressure,
    root_stretch_at,
    root_stretch_by_table,
    wall_pull,
    wall_stress,
    wall_stretch_at,
)
from analytical.bellows.reading import BALANCED, CORRECTED, PRINTED_READING, Reading
from analytical.laws.isotropic import Law
from analytical.laws.stability import stable_stretches

State = Literal["folded", "fully unfolded", "past the model"]


@dataclass(frozen=True, eq=False)
class ClosedFormPath:
    """Answer of a chain: arrays of the shape of the designs, then of the pressures.

    Attributes
    ----------
    dimensions, law, reading
        What was requested.
    pressure_kpa
        Pressures, kPa.
    root_stretch
        lambda_y, hoop stretch of the root's outer surface.
    wall_stretch
        lambda_a, stretch of the side wall along its length.
    drop_mm
        (R_p + t) - lambda_y (R_i + t), the radial height of the side wall, mm: 0 once fully unfolded.
    unfolding_pressure_kpa
        Pressure at which the root reaches the crest, kPa; shape of the designs, then 1.
    """

    dimensions: BellowsDimensions | BellowsDesigns
    law: Law
    reading: Reading
    pressure_kpa: FloatArray
    root_stretch: FloatArray
    wall_stretch: FloatArray
    drop_mm: FloatArray
    unfolding_pressure_kpa: FloatArray

    @cached_property
    def _sizes(self) -> Sizes:
        return Sizes.of(self.dimensions)

    @property
    def root_inner_stretch(self) -> FloatArray:
        """Hoop stretch of the root's inner surface, the largest of the root."""
        return self._sizes.inner_stretch(self.root_stretch, self.reading)

    @property
    def wall_stress_mpa(self) -> FloatArray:
        """Sigma, Cauchy stress of the side wall along its length, MPa."""
        return wall_stress(self.law, self.reading)(self.wall_stretch)

    @property
    def side_length_deformed_mm(self) -> FloatArray:
        """Deformed side length b = lambda_a l, mm."""
        return self.wall_stretch * self._sizes.side

    @cached_property
    def half_pitch_deformed_mm(self) -> FloatArray:
        """Deformed half pitch a, mm; NaN where eq. (23) has no real root."""
        square = self.side_length_deformed_mm**2 - self.drop_mm**2
        return np.asarray(np.sqrt(np.where(square >= 0.0, square, np.nan)))

    @property
    def angle_rad(self) -> FloatArray:
        """Angle theta between side wall and axis, cos(theta) = a / b, rad."""
        return np.asarray(np.arctan2(self.drop_mm, self.half_pitch_deformed_mm))

    @property
    def elongation_mm(self) -> FloatArray:
        """Elongation 2 n (a - e) of the whole actuator, mm."""
        return np.asarray(2.0 * self._sizes.convolutions * (self.half_pitch_deformed_mm - self._sizes.half_pitch))

    @property
    def extension_force_n(self) -> FloatArray:
        """Extension force of the pressure at the reading's cut, N; eq. (1)."""
        return np.asarray(1e-3 * self.pressure_kpa * self._sizes.cut(self.reading, self.root_stretch)[0])

    @property
    def resistive_force_n(self) -> FloatArray:
        """Force by which the wall resists, N: equal to the extension force in equilibrium."""
        _, area = self._sizes.cut(self.reading, self.root_stretch)
        inclined = self.drop_mm / self._sizes.side
        pull = wall_pull(wall_stress(self.law, self.reading), self.reading, inclined)
        return np.asarray(pull(self.wall_stretch) * area)

    @property
    def state(self) -> NDArray[np.str_]:
        """State of each entry: "folded", "fully unfolded" or "past the model".

        Past the model: the root has outgrown the crest (printed chain only) or a is not real.
        """
        past = (self.drop_mm < 0.0) | np.isnan(self.half_pitch_deformed_mm)
        unfolded = np.where(self.drop_mm == 0.0, "fully unfolded", "folded")
        return np.where(past, "past the model", unfolded)


def closed_form(
    dimensions: BellowsDimensions | BellowsDesigns, law: Law, pressure_kpa: ArrayLike, reading: Reading = CORRECTED
) -> ClosedFormPath:
    """Closed form of the paper with its misprints corrected (see the module's docstring).

    Parameters
    ----------
    dimensions
        One bellows, or many at once.
    law
        Hyperelastic law of the silicone.
    pressure_kpa
        Cavity pressures, kPa, not negative; a number or a one-dimensional array.
    reading
        How the equations are read; the default is the corrected chain.

    Returns
    -------
    ClosedFormPath
        Arrays of shape (m,) for one bellows, (..., m) for designs of shape (...).

    Raises
    ------
    BellowsError
        If a pressure is negative or not finite, the law cannot carry the stress, or is no longer stable on the way
        to it.
    """
    pressures_kpa = np.atleast_1d(np.asarray(pressure_kpa, dtype=float))
    if pressures_kpa.ndim != 1 or not np.all(np.isfinite(pressures_kpa)) or np.any(pressures_kpa < 0.0):
        raise BellowsError(f"pressure_kpa = {pressure_kpa!r} must be finite and not negative, in one dimension")
    sizes = Sizes.of(dimensions)
    pressure = np.broadcast_to(1e-3 * pressures_kpa, (*sizes.shape, len(pressures_kpa)))
    difference = root_difference(law, reading)
    at_crest = root_pressure(sizes, difference, reading, sizes.unfolded**2 - 1.0)
    if reading.tabulated_root:
        root_stretch = root_stretch_by_table(sizes, difference, reading, pressure)
    else:
        root_stretch = root_stretch_at(sizes, difference, reading, pressure, law.initial_shear_modulus_mpa, at_crest)
    drop = sizes.crest_outer - root_stretch * sizes.outer
    if not reading.folds_back:
        unfolded = pressure >= at_crest
        root_stretch = np.where(unfolded, sizes.unfolded, root_stretch)
        # Exactly zero once unfolded, not the round-off of a difference.
        drop = np.where(unfolded, 0.0, np.maximum(drop, 0.0))
    thrust_area, wall_area = sizes.cut(reading, root_stretch)
    wall_stretch = wall_stretch_at(law, reading, pressure * thrust_area / wall_area, drop / sizes.side)
    _refuse_softened(law, sizes, reading, root_stretch, wall_stretch)
    return ClosedFormPath(
        dimensions=dimensions,
        law=law,
        reading=reading,
        pressure_kpa=np.broadcast_to(pressures_kpa, pressure.shape),
        root_stretch=root_stretch,
        wall_stretch=wall_stretch,
        drop_mm=drop,
        unfolding_pressure_kpa=1e3 * at_crest,
    )


def _refuse_softened(
    law: Law, sizes: Sizes, reading: Reading, root_stretch: FloatArray, wall_stretch: FloatArray
) -> None:
    """Refuse stretches, all of pure shear, at which the law is not stable, and roots beyond a pressure that falls."""
    limit = stable_stretches(law)["pure shear"]
    if math.isinf(limit):
        return
    inner = sizes.inner_stretch(root_stretch, reading)
    difference = root_difference(law, reading)
    shares = np.linspace(0.0, 1.0, 41)[1:]
    on_the_way = [root_pressure(sizes, difference, reading, share * (root_stretch**2 - 1.0)) for share in shares]
    largest = float(max(np.max(inner), np.max(wall_stretch)))
    if largest > limit or np.any(np.diff(on_the_way, axis=0) < 0.0):
        raise BellowsError(
            f"{law} is no longer stable in pure shear at stretch {limit:.3g}, root or side wall would be stretched "
            f"{largest:.3g}-fold or the root gives way before: lower the pressure"
        )


def closed_form_printed(
    dimensions: BellowsDimensions | BellowsDesigns, law: Law, pressure_kpa: ArrayLike
) -> ClosedFormPath:
    """Closed form as printed, with |P| for the pressure; arguments and result as in `closed_form`.

    Ogden enters as printed: mu and alpha of the law in eq. (9) with j = theta and in eq. (20), whatever the law's
    convention. The root is not held at full unfolding: past it the chain folds back ("past the model").
    """
    return closed_form(dimensions, law, pressure_kpa, PRINTED_READING)


def closed_form_balanced(
    dimensions: BellowsDimensions | BellowsDesigns, law: Law, pressure_kpa: ArrayLike
) -> ClosedFormPath:
    """Closed form with the statics of the side wall corrected too; arguments and result as in `closed_form`."""
    return closed_form(dimensions, law, pressure_kpa, BALANCED)


def validity_warnings(path: ClosedFormPath, stretch_at_break: float) -> tuple[tuple[str, ...], ...]:
    """What to know of each entry of a path before quoting it.

    Parameters
    ----------
    path
        Of one bellows.
    stretch_at_break
        Stretch at which the silicone breaks, from its data sheet.

    Returns
    -------
    tuple of tuples of str
        Warnings per pressure; empty where there is nothing to warn of.
    """
    out = []
    states, inner = path.state, path.root_inner_stretch
    for k, pressure_kpa in enumerate(path.pressure_kpa):
        found = []
        if states[k] == "fully unfolded":
            found.append(
                f"fully unfolded from {path.unfolding_pressure_kpa[0]:.1f} kPa: the number rests on the root being "
                "held there; the paper disregards results beyond it"
            )
        if states[k] == "past the model":
            found.append(
                f"past the model at {pressure_kpa:g} kPa: the root has outgrown the crest and the bellows folds back"
            )
        for what, stretch in (("root", inner[k]), ("side wall", path.wall_stretch[k])):
            if stretch > stretch_at_break:
                found.append(f"the {what} is stretched {stretch:.2f}-fold, the silicone breaks at {stretch_at_break:g}")
        out.append(tuple(found))
    return tuple(out)
