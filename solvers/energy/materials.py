"""Materials of a problem's cells: a law and a bulk modulus for each number of cells that has its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.energy.laws import CompiledLaw, Law, MakeConstant, compile_law


@dataclass(frozen=True)
class Material:
    """A law, and 1/kappa in 1/MPa; 0 is incompressible."""

    law: Law
    inverse_kappa: float


@dataclass(frozen=True)
class Part:
    """The cells of one material, ready for forms.

    Attributes
    ----------
    number
        Of the cells.
    law, inverse_kappa
        The law in UFL, and 1/kappa as a UFL constant.
    measure
        Cell measure of the part, quadrature degree included.
    field
        Which of the space's pressures is the part's.
    """

    number: int
    law: CompiledLaw
    inverse_kappa: Any
    measure: Any
    field: int


def compile_parts(
    materials: Mapping[int, Material], constant: MakeConstant, measures: Mapping[int, Any], fields: Sequence[int]
) -> tuple[Part, ...]:
    """The parts of a mesh; numbers of materials are UFL constants, so that new ones need no compilation.

    Parameters
    ----------
    materials
        By the cells' numbers.
    constant
        As in `compile_law`.
    measures
        Cell measure of each number.
    fields
        Numbers of cells that have a pressure of their own, in the space's order; empty if all share one.
    """
    return tuple(
        Part(
            number,
            compile_law(material.law, constant),
            constant(material.inverse_kappa),
            measures[number],
            fields.index(number) if fields else 0,
        )
        for number, material in materials.items()
    )


def invariant_limits(parts: Sequence[Part]) -> tuple[float, float]:
    """Largest (I1, I2) for which the numbers of those laws hold that have a limit."""
    limits = np.array([part.law.invariant_limits for part in parts])
    return float(limits[:, 0].min()), float(limits[:, 1].min())


def limited_cells(parts: Sequence[Part], numbers: Any) -> Any:
    """Which cells have a law whose numbers hold up to a limit; ``numbers`` are those of the cells."""
    return np.isin(numbers, [part.number for part in parts if np.isfinite(part.law.invariant_limits).all()])
