"""Runs of a finer mesh that start from the states of a coarser one, at the requested loads only.

The path itself, and where stability is lost on it, is found on the coarser mesh; on the finer one each requested state
is Newton's from the coarse one, with its own count of unstable modes. Where that is not enough the path is followed
whole: if the coarse path lost its stability or passed a limit point, if a count differs, or if Newton's method fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from meshes.errors import MeshError
from meshes.solid import SolidMesh
from solvers.paths.orders import LOADS
from solvers.paths.states import GuessMemory, PathMemory, PathSettings, PathState
from solvers.paths.states import Path as EquilibriumPath
from solvers.paths.warm_start import follow_guesses
from solvers.state import State
from studies.models.contact import MODELLED
from studies.models.finer.prolongation import Prolongation
from studies.models.run_log import Log
from studies.results.run_files import load_state
from studies.results.runs import Run

# Begins the note of a run that has followed no path of its own, and of one that had to.
STARTED, NOT_STARTED = "requested loads only, ", "path followed whole: "


@dataclass(frozen=True)
class Coarser:
    """A finished run on a coarser mesh of the same scene and model, and its folder."""

    run: Run
    folder: Path

    @property
    def level(self) -> str:
        """Its mesh."""
        return self.run.summary.level

    @property
    def contact_notes(self) -> list[str]:
        """What it tells of contact."""
        return [note for note in self.run.summary.plan if note.startswith(MODELLED)]

    def states(self) -> list[State] | None:
        """Its states at the requested loads, if a finer mesh may start from them.

        Only where the path is stable all the way: elsewhere two meshes need not be on the same branch.
        """
        summary, rows = self.run.summary, self.run.requested
        stable = all(not row.unstable_modes > 0.0 and math.isnan(row.limit_kpa) for row in self.run.path)
        if summary.status != "reached" or summary.crossing or not stable:
            return None
        saved = [load_state(self.folder, summary.content_hash, 1e-3 * row.pressure_kpa) for row in rows]
        return None if None in saved else [item[0] for item in saved if item is not None]


class _Differs(Exception):
    """A state is not what the coarse one lets expect; the text says how."""


def follow_from(
    coarser: Coarser | None,
    coarse_mesh: Callable[[], SolidMesh],
    log: Log,
    whole: Callable[[], EquilibriumPath],
    touches: Callable[[PathState], bool] = lambda _: False,
) -> EquilibriumPath:
    """The requested states of a run from those of a coarser mesh, or else its whole path. Every rank calls.

    Parameters
    ----------
    coarser
        The coarser run; None to follow the path.
    coarse_mesh
        Makes its mesh.
    log
        The run, which may go on from a checkpoint of either kind.
    whole
        Follows the path.
    touches
        True of a state whose surfaces touch though the problem has no contact.
    """
    states = None if coarser is None or isinstance(log.memory, PathMemory) else log.comm.bcast(_read(coarser, log))
    if coarser is None or states is None:
        if isinstance(log.memory, GuessMemory):  # its checkpoint is from when there was a coarser run
            log.start_anew(_path_notes(log))
        return whole()

    def take(item: PathState) -> None:
        count = item.newton.excess_negatives
        if count:
            raise _Differs(f"{count} unstable modes at {1e3 * item.state.load_mpa:.6g} kPa, none on {coarser.level}")
        if touches(item):
            raise _Differs(f"surfaces touch at {1e3 * item.state.load_mpa:.6g} kPa, not on {coarser.level}")
        log.keep(item)

    if log.memory is None:
        log.notes.append(f"{STARTED}each from the state on {coarser.level}; the path between them is that mesh's")
        log.notes += [note for note in coarser.run.summary.plan if note.startswith(LOADS)]
    try:
        carry = Prolongation(coarse_mesh(), log.mesh)
        path = follow_guesses(
            log.problem,
            log.factor,
            [carry(state) for state in states],
            PathSettings(crossing_tolerance=0.0),
            log.job.progress.iteration,
            on_state=take,
            on_step=log.step,
            resume=log.memory if isinstance(log.memory, GuessMemory) else None,
        )
        why = path.reason
    except (_Differs, MeshError) as difference:
        why = str(difference)
    if not why:
        return path
    log.start_anew([*_path_notes(log), f"{NOT_STARTED}{why}"])
    return whole()


def _path_notes(log: Log) -> list[str]:
    """Notes of a run that follows its path."""
    return [note for note in log.notes if not note.startswith((STARTED, LOADS))]


def _read(coarser: Coarser, log: Log) -> list[State] | None:
    """The coarse states on rank 0."""
    return coarser.states() if log.comm.rank == 0 else None
