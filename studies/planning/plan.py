"""The plan of a scene: which runs are made of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from studies.planning.error_model import Choice
from studies.planning.levels import BODY_MERIDIANS, MOST_UNKNOWNS, Model


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
        True to leave out levels beyond the second, or with `one_mesh` the first, once those before hold the scene's
        tolerance, or a 3D body's share.
    skipped
        What is not computed and why, a sentence each.
    around_levels
        Of a bellows: numbers of cells round the circumference of the 3D runs; empty for none.
    body_levels
        Meridians that a 3D run may be made from: the first whose error is within its share of the tolerance, or the
        last.
    finer
        Meshes beyond ``levels``, solved one after another as long as the scene's tolerance is not met, the last one
        reached its loads and the next has no more than `MOST_UNKNOWNS`.
    fixed
        True if the meshes are chosen for another purpose than the scene's tolerance: nothing is judged by it.
    choice
        The mesh that the error model proposes and what it expects of it; None where it knows nothing of the scene.
    one_mesh
        True if the first mesh tells its own error: the second is then solved only if that is too large.
    """

    model: Model
    levels: tuple[str, ...]
    stop_when_met: bool
    skipped: tuple[str, ...]
    around_levels: tuple[int, ...] = ()
    body_levels: tuple[int, ...] = BODY_MERIDIANS
    finer: tuple[str, ...] = ()
    fixed: bool = False
    choice: Choice | None = None
    one_mesh: bool = False

    @property
    def certain(self) -> tuple[str, ...]:
        """Levels that are solved in any case."""
        if not self.stop_when_met:
            return self.levels
        return self.levels[: 1 if self.one_mesh else 2]

    @property
    def perhaps(self) -> tuple[str, ...]:
        """Levels that are solved only if those before are not good enough."""
        return self.levels[len(self.certain) :]

    def as_fixed(self) -> Plan:
        """The same meshes, whatever they leave of error."""
        return replace(self, finer=(), fixed=True)


def ways(plan: Plan, loads: str, whole: bool = False) -> list[tuple[str, str]]:
    """Each level of a plan and how its loads are come to, in words; with ``whole`` by its own path on every one."""
    found = []
    for before, level in zip(("", *plan.levels), plan.levels, strict=False):
        way = f"{loads} from the states on {before}" if before and not whole else f"path from 0 through {loads}"
        found.append((level, way + (" (only if needed)" if level in plan.perhaps else "")))
    return found


def tolerance_lines(plan: Plan, tolerance_percent: float) -> list[str]:
    """What is done for a tolerance that these meshes do not hold, for a terminal."""
    if not plan.finer:
        return []
    most = f"{MOST_UNKNOWNS[plan.model]:,}"
    return [
        f"  finer meshes one after another while {tolerance_percent:g} % is not met, of up to {most} unknowns; if it "
        "is not met then, the exit code is 3"
    ]
