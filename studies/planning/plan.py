"""The plan of a scene: which runs are made of it."""

from __future__ import annotations

from dataclasses import dataclass

from studies.planning.error_model import Choice
from studies.planning.levels import BODY_MERIDIANS, Model


@dataclass(frozen=True)
class Plan:
    """The runs of a scene.

    Attributes
    ----------
    model
        The model whose result is the answer.
    levels
        Meshes, coarsest first: of a bellows the meridians of the axisymmetric runs, of a simple body those of its
        model, the last of which is the answer.
    stop_when_met
        True to leave out levels beyond the second once those before hold the scene's tolerance, or a 3D body's share.
    skipped
        What is not computed and why, a sentence each.
    around_levels
        Of a bellows: numbers of cells round the circumference of the 3D runs; empty for none.
    sector_levels
        The same of a sector beside full 3D, for the circumference's part of the error; empty for none.
    body_levels
        Meridians that a 3D run may be made from: the first whose error is within its share of the tolerance, or the
        last.
    choice
        The mesh that the error model proposes and what it expects of it; None where it knows nothing of the scene.
    """

    model: Model
    levels: tuple[str, ...]
    stop_when_met: bool
    skipped: tuple[str, ...]
    around_levels: tuple[int, ...] = ()
    sector_levels: tuple[int, ...] = ()
    body_levels: tuple[int, ...] = BODY_MERIDIANS
    choice: Choice | None = None

    @property
    def certain(self) -> tuple[str, ...]:
        """Levels that are solved in any case."""
        return self.levels[:2] if self.stop_when_met else self.levels

    @property
    def perhaps(self) -> tuple[str, ...]:
        """Levels that are solved only if those before are not good enough."""
        return self.levels[len(self.certain) :]
