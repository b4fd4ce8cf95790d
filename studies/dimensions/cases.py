"""The one case of the study: how finely dimensions are searched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Steps:
    """Steps of the grids of R_p, R_i and e, mm.

    Attributes
    ----------
    search_mm
        Where every set that fits is looked for. One-off trial: half the step finds eight times as many (9290 for 1149);
        the ranges of what they predict widen by 1 to 3 %, for the shallowest folds more (blocked tip: 45 to 55 N).
    drawing_mm
        The sets to work with have dimensions that a designer would draw.
    mould_mm
        How far the rule would go without the drawing: as fine as a mould is printed.
    """

    search_mm: float = 0.25
    drawing_mm: float = 0.5
    mould_mm: float = 0.1
    name: str = "dimensions"


def cases(options: Mapping[str, Any]) -> list[Steps]:
    """The steps of the study."""
    return [Steps()]
