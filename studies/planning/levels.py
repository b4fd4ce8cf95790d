"""Models and names of their meshes: ``r4`` is a meridian refined four times, ``n8r2`` a body with 8 cells round on r2.

In a name r refines the meridian, m a user's mesh, and n is the number of cells round the whole circumference (of a
cube: along an edge). What meshes lead to has a name of its own, `LIMIT`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Model = Literal["closed_form", "axisymmetric", "sector", "full3d"]
MODELS: tuple[Model, ...] = ("closed_form", "axisymmetric", "sector", "full3d")
# Refinements of a meridian for the error estimate, coarsest first.
MERIDIANS = (1, 2, 4)
# In place of a mesh: the value that a model's meshes lead to, better than that of the finest.
LIMIT = "extrapolated"
# Finer ones, for a tolerance that those do not hold, as long as they have no more unknowns than `MOST_UNKNOWNS`.
FINER_MERIDIANS = (8, 16, 32)
# Up to how many unknowns a mesh is refined for a tolerance: minutes on one core, 6 GB (docs/decisions.md, "Tolerance").
MOST_UNKNOWNS: Mapping[Model, int] = {"axisymmetric": 1_000_000, "sector": 500_000, "full3d": 500_000}
# Meridians that bodies are made from: those on r4 would not fit the machines this is meant for (24 GB).
BODY_MERIDIANS = (1, 2)


@dataclass(frozen=True)
class BodyLevel:
    """Mesh of a body of revolution.

    Attributes
    ----------
    around
        Cells round the whole circumference.
    meridian
        Refinement of the meridian it is made from.
    """

    around: int
    meridian: int = 1

    @property
    def name(self) -> str:
        """For instance ``n8r2``; ``n8`` on the coarsest meridian."""
        return f"n{self.around}" + (f"r{self.meridian}" if self.meridian > 1 else "")


def body_level(name: str) -> BodyLevel:
    """The mesh a name stands for."""
    found = re.fullmatch(r"n(\d+)(?:r(\d+))?", name)
    if found is None:
        raise ValueError(f"{name!r}: not the name of a body's mesh, such as n8 or n8r2")
    return BodyLevel(int(found[1]), int(found[2] or 1))


def fineness(level: str) -> int:
    """First number in a level's name (``r4``: 4, ``n24r2``: 24); 0 if it has none."""
    found = re.search(r"\d+", level)
    return int(found[0]) if found else 0


def ranking(level: str) -> tuple[float, int]:
    """By what levels of a model are put in order: refinement, then cells round; `LIMIT` comes last."""
    if level == LIMIT:
        return math.inf, 0
    numbers = {letter: int(number) for letter, number in re.findall(r"([rnm])(\d+)", level)}
    return numbers.get("r", numbers.get("m", 1)), numbers.get("n", 0)
