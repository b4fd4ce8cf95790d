"""Sets of dimensions that fit the printed closed form, many at once, and what a chain says of them.

The corrected chain is linear in n and, for a given silicone, an actuator's elongation depends on (R_i, R_p, t, e)
only: four fields per grid are enough for every silicone, order and n.
Units: mm, N, MPa; pressures in kPa, elongations compared in cm as printed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray, IntArray
from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.dimensions import BellowsDesigns
from analytical.bellows.paper import (
    LAWS,
    PRINTED,
    PRINTED_PRESSURE_KPA,
    PRINTED_ROOT_RADIUS_MM,
    InferredFamily,
    Silicone,
)
from analytical.bellows.reading import BALANCED, CORRECTED, PRINTED_READING, Reading
from analytical.laws.isotropic import Law
from analytical.laws.silicones import dragon_skin_30

# The rule of the fit, chosen before it was run: a set fits if no printed closed-form number is off by more.
WITHIN: Final = 0.05

SILICONES: Final[tuple[Silicone, ...]] = tuple(LAWS)
WALLS_MM: Final = np.array([row.wall_mm for row in PRINTED])
HAS_LARGER_ROOT: Final = np.array([row.has_larger_root for row in PRINTED])


class FitError(ValueError):
    """A grid that cannot be searched or members that leave nothing to pick; names value and remedy."""


@dataclass(frozen=True)
class Chain:
    """A chain of the closed form with the laws of the two silicones.

    Attributes
    ----------
    label
        For people.
    reading
        How it reads the equations.
    laws
        Law of each silicone.
    """

    label: str
    reading: Reading
    laws: Mapping[Silicone, Law]


# The one the dimensions are inferred with, and those it is compared with.
CORRECTED_CHAIN: Final = Chain("corrected chain", CORRECTED, LAWS)
BALANCED_CHAIN: Final = Chain("balanced chain", BALANCED, LAWS)
PRINTED_CHAIN: Final = Chain("printed chain", PRINTED_READING, LAWS)
CORRECTED_CHAIN_BY_20: Final = Chain(
    "corrected chain, Dragon Skin 30 as in eq. (20)", CORRECTED, {**LAWS, "dragon-skin-30": dragon_skin_30("mu/alpha")}
)


@dataclass(frozen=True)
class ReadingOrder:
    """Which number of each pair belongs to R_i = 5 mm.

    Attributes
    ----------
    thin_reversed, thick_reversed
        False: the first that the text names, of the 1 mm and of the 2 mm pair. True: the second.
    """

    thin_reversed: bool
    thick_reversed: bool

    @property
    def closed_form_cm(self) -> FloatArray:
        """Printed closed-form elongations in the order of `PRINTED` under this reading, shape (4,), cm."""
        thin_5, thin_larger, thick_5, thick_larger = (row.closed_form_cm for row in PRINTED)
        if self.thin_reversed:
            thin_5, thin_larger = thin_larger, thin_5
        if not self.thick_reversed:  # PRINTED has the 2 mm pair reversed
            thick_5, thick_larger = thick_larger, thick_5
        return np.array([thin_5, thin_larger, thick_5, thick_larger])

    def __str__(self) -> str:
        """Name for tables."""
        return ", ".join(
            f"{wall} mm {'reversed' if turned else 'as named'}"
            for wall, turned in ((1, self.thin_reversed), (2, self.thick_reversed))
        )


ORDERS: Final = tuple(ReadingOrder(*turned) for turned in itertools.product((False, True), repeat=2))
# The text says that a larger root radius elongates less: R_i = 5 has the larger number of each pair.
TEXT_ORDER: Final = ORDERS.index(ReadingOrder(False, True))


@dataclass(frozen=True, eq=False)
class Members:
    """Sets of dimensions that fit, one per entry of every array, m of them.

    Attributes
    ----------
    silicone
        Index into `SILICONES` of each of the four actuators, shape (m, 4), in the order of `PRINTED`.
    order
        Index into `ORDERS`, shape (m,).
    crest_radius_mm, larger_root_radius_mm, half_pitch_mm
        R_p, the second R_i, e, mm, shape (m,).
    convolutions
        n, shape (m,).
    error
        Elongation at 20 kPa over the printed closed-form one, less 1, shape (m, 4).
    """

    silicone: IntArray
    order: IntArray
    crest_radius_mm: FloatArray
    larger_root_radius_mm: FloatArray
    half_pitch_mm: FloatArray
    convolutions: IntArray
    error: FloatArray

    def __len__(self) -> int:
        return len(self.order)

    @classmethod
    def joined(cls, parts: Iterable[Members]) -> Members:
        """The entries of all parts, one after the other."""
        every = tuple(parts)
        return cls(*(np.concatenate([getattr(part, f.name) for part in every]) for f in fields(cls)))

    def take(self, which: BoolArray | IntArray) -> Members:
        """The entries under a mask or at indices."""
        return Members(*(getattr(self, f.name)[which] for f in fields(self)))

    @property
    def worst_error(self) -> FloatArray:
        """Largest |error| of the four, shape (m,)."""
        return np.asarray(np.abs(self.error).max(axis=1))

    @property
    def root_radius_mm(self) -> FloatArray:
        """R_i of each actuator, mm, shape (m, 4)."""
        return np.where(HAS_LARGER_ROOT, self.larger_root_radius_mm[:, None], PRINTED_ROOT_RADIUS_MM)

    @property
    def one_silicone_per_wall(self) -> BoolArray:
        """Whether both actuators of a wall thickness have the same silicone, shape (m,)."""
        s = self.silicone
        return np.asarray((s[:, 0] == s[:, 1]) & (s[:, 2] == s[:, 3]))

    @property
    def designs(self) -> BellowsDesigns:
        """Dimensions of all actuators, shape (m, 4)."""
        return BellowsDesigns(
            root_radius_mm=self.root_radius_mm,
            crest_radius_mm=self.crest_radius_mm[:, None],
            wall_mm=WALLS_MM,
            half_pitch_mm=self.half_pitch_mm[:, None],
            convolutions=self.convolutions[:, None],
        )

    def family(self, index: int, label: str = "") -> InferredFamily:
        """An entry as dimensions to work with; its reading order must be that of `PRINTED`."""
        if self.order[index] != TEXT_ORDER:
            raise FitError(f"order = {ORDERS[self.order[index]]}: a family reads the pairs as {ORDERS[TEXT_ORDER]}")
        a, b, c, d = (SILICONES[s] for s in self.silicone[index])
        return InferredFamily(
            larger_root_radius_mm=float(self.larger_root_radius_mm[index]),
            crest_radius_mm=float(self.crest_radius_mm[index]),
            half_pitch_mm=float(self.half_pitch_mm[index]),
            convolutions=int(self.convolutions[index]),
            silicones=(a, b, c, d),
            label=label,
        )


def members_of(families: tuple[InferredFamily, ...], chain: Chain = CORRECTED_CHAIN) -> Members:
    """Families as members, whether they fit or not."""
    bare = Members(
        silicone=np.array([[SILICONES.index(s) for s in f.silicones] for f in families]),
        order=np.full(len(families), TEXT_ORDER),
        crest_radius_mm=np.array([f.crest_radius_mm for f in families]),
        larger_root_radius_mm=np.array([f.larger_root_radius_mm for f in families]),
        half_pitch_mm=np.array([f.half_pitch_mm for f in families]),
        convolutions=np.array([f.convolutions for f in families]),
        error=np.zeros((len(families), len(PRINTED))),
    )
    return replace(bare, error=errors_of(bare, chain))


def per_actuator(
    members: Members,
    measure: Callable[[BellowsDesigns, Law], FloatArray],
    laws: Mapping[Silicone, Law] = LAWS,
) -> FloatArray:
    """Any number per actuator, for all members at once.

    Parameters
    ----------
    members
        m of them.
    measure
        Called once per silicone, with designs of shape (k,) and the silicone's law; returns shape (k,).
    laws
        Law of each silicone.

    Returns
    -------
    ndarray
        Shape (m, 4).
    """
    designs = members.designs
    size = {f.name: np.broadcast_to(getattr(designs, f.name), designs.shape) for f in fields(designs)}
    out = np.empty(designs.shape)
    for index, name in enumerate(SILICONES):
        mask = members.silicone == index
        if np.any(mask):
            out[mask] = measure(BellowsDesigns(**{key: value[mask] for key, value in size.items()}), laws[name])
    return out


def tip_mm(members: Members, pressure_kpa: float = PRINTED_PRESSURE_KPA, chain: Chain = CORRECTED_CHAIN) -> FloatArray:
    """Elongation of every actuator at a pressure, mm, shape (m, 4); NaN where it is past the chain's model."""
    return per_actuator(
        members, lambda d, law: within_model_mm(closed_form(d, law, pressure_kpa, chain.reading)), chain.laws
    )


def wall_stretch(members: Members, chain: Chain = CORRECTED_CHAIN) -> FloatArray:
    """lambda_a of every actuator at 20 kPa, shape (m, 4)."""
    return per_actuator(
        members,
        lambda d, law: closed_form(d, law, PRINTED_PRESSURE_KPA, chain.reading).wall_stretch[:, 0],
        chain.laws,
    )


def within_model_mm(path: ClosedFormPath) -> FloatArray:
    """Elongation at the path's one pressure, mm, shape of the designs; NaN where it is past the model."""
    return np.where(path.state == "past the model", np.nan, path.elongation_mm)[..., 0]


def errors_of(members: Members, chain: Chain) -> FloatArray:
    """Elongation at 20 kPa over the printed one, less 1, shape (m, 4)."""
    targets_mm = 10.0 * np.array([order.closed_form_cm for order in ORDERS])
    return np.asarray(tip_mm(members, PRINTED_PRESSURE_KPA, chain) / targets_mm[members.order] - 1.0)
