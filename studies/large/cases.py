"""The points of the study of large bodies: sizes, and how each is solved."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from studies.large.measure import Method

METHODS: Final[tuple[Method, ...]] = ("direct", "iterative")


@dataclass(frozen=True)
class Size:
    """A body: a scene of ``scenes``, cells round its circumference, refinement of its meridian."""

    scene: str
    around: int
    refinement: int

    @property
    def label(self) -> str:
        """For file names."""
        return f"{self.scene}-n{self.around}r{self.refinement}"


# Bodies in order of size: 25,000 to 1.2 million unknowns.
SIZES: Final = (
    Size("smoke-t2-ri5", 8, 1),
    Size("smoke-t2-ri5", 16, 1),
    Size("heung-t2-ri5", 8, 1),
    Size("heung-t2-ri5", 16, 1),
    Size("heung-t2-ri5", 32, 1),
    Size("heung-t2-ri5", 24, 2),
    Size("heung-t2-ri5", 48, 2),
)
# The body that is measured on one rank and on two, for the estimate.
OF_SCALING: Final = SIZES[2]


@dataclass(frozen=True)
class Point:
    """A size, how it is solved, on how many ranks, and until when it may begin, seconds of the performance counter."""

    size: Size
    method: Method
    ranks: int
    until_s: float

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.size.label} {self.method}, ranks: {self.ranks}"

    @property
    def label(self) -> str:
        """For file names."""
        return f"{self.size.label}-{self.method}-{self.ranks}"


def cases(options: Mapping[str, Any]) -> list[Point]:
    """All sizes with both solvers on a number of ranks, and one size on one rank too; time runs from now on."""
    until_s = time.perf_counter() + 60.0 * options["minutes"]
    return [
        Point(size, method, ranks, until_s)
        for size in SIZES[: options["limit"]]
        for ranks in sorted({1, options["ranks"]} if size == OF_SCALING else {options["ranks"]})
        for method in METHODS
    ]
