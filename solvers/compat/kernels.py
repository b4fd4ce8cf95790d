"""The integrals of a compiled form: their kernels, where they are taken, and what the kernels need."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx.fem import IntegralType
from numpy.typing import NDArray

from solvers.compat import packed, stack

# Places of the types of integrals in a form are the same in all versions.
_TYPES = (IntegralType.cell, IntegralType.exterior_facet)


@dataclass(frozen=True)
class Integral:
    """An integral over cells or over facets of the boundary.

    Attributes
    ----------
    kernel
        FFCx' ``tabulate_tensor`` in double precision.
    cells, facets
        Local cell of each of its n entities, shape (n,), and the facet's number in it; zero over cells.
    coefficients
        What the form's functions have at each entity, shape (n, w).
    """

    kernel: Any
    cells: NDArray[np.int32]
    facets: NDArray[np.int32]
    coefficients: NDArray[np.float64]


def integrals(form: Any) -> tuple[list[Integral], NDArray[np.float64]]:
    """Integrals of a compiled form that this rank has a part of, in the order of dolfinx, and the form's constants."""
    inner, constants, coefficients = packed(form)
    assert set(inner.integral_types) <= set(_TYPES)
    found = []
    for place, kind in enumerate(_TYPES):
        for key, integral in stack.kernels(form, inner, kind, place):
            entities = np.asarray(inner.domains(kind, key), dtype=np.int32)
            if not entities.size:
                continue
            cells, facets = entities.reshape(-1, 2).T if place else (entities, np.zeros_like(entities))
            at = (np.ascontiguousarray(cells), np.ascontiguousarray(facets))
            found.append(Integral(integral.tabulate_tensor_float64, *at, np.ascontiguousarray(coefficients[kind, key])))
    return found, np.ascontiguousarray(constants)
