"""Names of meshes: ``r4`` is a meridian refined four times, ``n8r2`` a body with 8 cells round made from ``r2``."""

from __future__ import annotations

import re
from dataclasses import dataclass


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


def ranking(level: str) -> tuple[int, int]:
    """By what levels of a model are put in order: refinement of the meridian, then cells round."""
    numbers = {letter: int(number) for letter, number in re.findall(r"([rn])(\d+)", level)}
    return numbers.get("r", 1), numbers.get("n", 0)
