"""Every departure from the printed equations of Heung et al. 2024, with what it is worth.

Source: Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3. The chains are in `bellows.chains`.
Effects are computed, not stored: `effect_cm` for any actuator and pressures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDimensions
from analytical.bellows.reading import BALANCED, CORRECTED, Reading
from analytical.laws.isotropic import Law

Chain = Literal["closed_form", "closed_form_balanced"]


@dataclass(frozen=True)
class Correction:
    """One departure from the printed equations.

    Attributes
    ----------
    name
        Short name.
    equation
        Where in the paper.
    fault
        What is wrong there.
    corrected_to
        What is done instead.
    evidence
        How it was established.
    chain
        The first chain that has it: ``closed_form`` (misprints) or ``closed_form_balanced`` (statics too).
    without, with_
        Readings of the corrected chain without and with this one item. Equal where the item changes wording but no
        number; None where the print cannot be evaluated.
    """

    name: str
    equation: str
    fault: str
    corrected_to: str
    evidence: str
    chain: Chain = "closed_form"
    without: Reading | None = CORRECTED
    with_: Reading = CORRECTED


CORRECTIONS: Final[tuple[Correction, ...]] = (
    Correction(
        name="crest radius",
        equation="(1)",
        fault="the text calls R_p the internal area",
        corrected_to="R_p is a radius",
        evidence="pi R_p^2 in the equation itself, and the key of figure 2",
    ),
    Correction(
        name="sign of the pressure",
        equation="(6), (11), (12), (16), (17)",
        fault="with the printed limits no root that widens carries a positive pressure; the first integral in (6) "
        "starts at -r_o, a radius for a stress; the text has sigma_r = +P at the inner surface",
        corrected_to="P = int (sigma_theta - sigma_r) / r dr from r_i to r_o; in (6) d(sigma_r) from -P to 0; the "
        "printed chain takes |P|",
        evidence="equilibrium (5) with sigma_r = -P inside and 0 outside; energy balance of the exact tube",
        without=None,
    ),
    Correction(
        name="local radius",
        equation="(13)",
        fault="dr = R_i / (1 - lambda^2) d(lambda) uses the inner radius throughout the wall",
        corrected_to="the local undeformed radius: dr / r = d(lambda) / (lambda (1 - lambda^2))",
        evidence="r^2 - R^2 is the same for all particles; the second line of (11) already has it",
    ),
    Correction(
        name="Ogden derivative at the root",
        equation="(9), (10), (12), (17)",
        fault="the derivative by lambda_j of the mu/alpha form stands where dW/dI1 belongs, j is left open (initial "
        "shear modulus 151 kPa for any j); an Ogden energy is no function of I1",
        corrected_to="sigma_theta - sigma_r of the law: k alpha (lambda^alpha - lambda^-alpha), k as in eq. (3); the "
        "printed chain takes j = theta",
        evidence="Cauchy stress of (3) by differentiation",
        without=Reading(root_derivative="theta"),
    ),
    Correction(
        name="the same with j = r",
        equation="(9), (10)",
        fault="as before, with the other choice of j",
        corrected_to="as before",
        evidence="as before",
        without=Reading(root_derivative="r"),
    ),
    Correction(
        name="the same with j = z",
        equation="(9), (10)",
        fault="as before, with the other choice of j",
        corrected_to="as before",
        evidence="as before",
        without=Reading(root_derivative="z"),
    ),
    Correction(
        name="inner stretch",
        equation="(14)",
        fault="the square root is linearised",
        corrected_to="lambda_i^2 = 1 + (1 + t/R_i)^2 (lambda_o^2 - 1)",
        evidence="the wall keeps its area; (14) is its first-order expansion in lambda_o^2 - 1",
        without=Reading(linear_inner_stretch=True),
    ),
    Correction(
        name="steps of the root stretch",
        equation="text after (17)",
        fault="lambda_y is tabulated in steps of 0.1; how to read between them is not said",
        corrected_to="the pressure is inverted to round-off; the printed chain interpolates linearly",
        evidence="the inversion satisfies (16) to round-off",
        without=Reading(tabulated_root=True),
    ),
    Correction(
        name="Ogden convention of the wall",
        equation="(20)",
        fault="the mu/alpha form, initial shear modulus 220 kPa, where the energy (3) has 75 kPa",
        corrected_to="the same law as at the root, whose convention the caller names",
        evidence="Cauchy stress of (3) by differentiation; the maker's 100 % modulus of Dragon Skin 30, about 593 kPa, "
        "is nearer to (3)'s 737 kPa than to (20)'s 2150 kPa",
        without=Reading(wall_by_20=True),
    ),
    Correction(
        name="wall offset",
        equation="(21), (22)",
        fault="R_p - lambda_y R_i - t subtracts t and stretches R_i by the outer surface's stretch",
        corrected_to="a from (23); in (22) the same a stands on both sides and cancels",
        evidence="only (23) gives a = e at rest with l^2 = e^2 + (R_p - R_i)^2",
    ),
    Correction(
        name="strain for stretch",
        equation="text after (21)",
        fault="lambda_y is called a strain",
        corrected_to="it is a stretch",
        evidence="figure 2 and the text after (17), where it starts from 1",
    ),
    Correction(
        name="full unfolding",
        equation="(23)",
        fault="beyond lambda_y (R_i + t) = R_p + t the root outgrows the crest and the bellows folds back",
        corrected_to="lambda_y stays there; the side wall goes on stretching",
        evidence="the text steps lambda_y until full expansion of the roots and disregards what follows",
        without=Reading(folds_back=True),
    ),
    Correction(
        name="elongation of the whole",
        equation="(23)",
        fault="the text calls it the displacement of each pitch, but the factor n is in it",
        corrected_to="it is the displacement of the actuator",
        evidence="2 n half pitches make the actuator",
    ),
    Correction(
        name="wall on the deformed area",
        equation="(19), (20), (22)",
        fault="the Cauchy stress acts on the undeformed area of the wall",
        corrected_to="sigma A / lambda_a: in pure shear the wall thins by lambda_a and its circumference stays",
        evidence="force = Cauchy stress times deformed area; virtual work of W(lambda_a)",
        chain="closed_form_balanced",
        with_=Reading(wall_on_deformed_area=True),
    ),
    Correction(
        name="wall along the axis",
        equation="(19), (22)",
        fault="cos(theta) is put into the stress and divided out again, so the geometry drops out of the balance",
        corrected_to="the axial force of an inclined wall is its tension times a / b",
        evidence="equilibrium of the cut",
        chain="closed_form_balanced",
        with_=Reading(wall_along_axis=True),
    ),
    Correction(
        name="one cut",
        equation="(1), (22)",
        fault="thrust at the crest, R_p^2, wall area at the root, (R_i + t)^2 - R_i^2",
        corrected_to="both as the mean over all cuts of the half pitch, which is the virtual work of the model's own "
        "motion",
        evidence="dW(lambda_a) = P dV of the cone frustum between root and crest",
        chain="closed_form_balanced",
        with_=Reading(cut="mean"),
    ),
    Correction(
        name="all three of the statics",
        equation="(1), (19) to (22)",
        fault="as the last three",
        corrected_to="as the last three, together",
        evidence="as the last three",
        chain="closed_form_balanced",
        with_=BALANCED,
    ),
)


def effect_cm(correction: Correction, dimensions: BellowsDimensions, law: Law, pressure_kpa: ArrayLike) -> FloatArray:
    """What a correction is worth: elongation with it less elongation without it, all else as in the corrected chain.

    Parameters
    ----------
    correction
        One of `CORRECTIONS`.
    dimensions, law, pressure_kpa
        As in `chains.closed_form`.

    Returns
    -------
    ndarray
        Shape of the pressures, cm; NaN where the print cannot be evaluated.
    """
    if correction.without is None:
        return np.full(np.atleast_1d(pressure_kpa).shape, np.nan)
    with_it, without = (
        closed_form(dimensions, law, pressure_kpa, reading).elongation_mm
        for reading in (correction.with_, correction.without)
    )
    return np.asarray(0.1 * (with_it - without))
