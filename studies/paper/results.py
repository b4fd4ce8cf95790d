"""What the paper study has found: its cases with their runs and rows, read from its folder, and looked up.

What has not been run is no exception: a case without runs, a row without a number.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analytical.bellows import chains, loads
from studies.models.modes import FoundCrossing, read_crossings
from studies.models.session import SCENE_FILE, SceneResult, read_scene_folder
from studies.paper.cases import DRAWN, HIGHEST_KPA, REFERENCE_SCENES, Case, Group, cases
from studies.report.labels import TIP
from studies.report.numbers import MISSING
from studies.results import measured_rows, measures, runs, uncertainty
from studies.results.kept import content_key, kept
from studies.results.rows import FOLDED_BACK, Row, row
from studies.results.run_files import RunSummary
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.dimension_sets import CHAIN_OF
from studies.scene.load import load_bellows

# Modules that decide what is measured in the states of a run, beside the code that the run is keyed by.
_MEASURING: Final = (measures, measured_rows, chains, loads, runs, uncertainty)
# What is kept of the many drawn sets: at every pressure, and at the highest alone.
_AT_ALL: Final = (TIP, "root_bulge_mm")
_AT_HIGHEST: Final = (
    "tip_centre_mm",
    "unstable_modes",
    "root_stretch_outer",
    "wall_stretch",
    "unfolding_share",
    "peak_stretch_away",
    "cavity_volume_ratio",
)
_LIMIT: Final = re.compile(r"up to ([\d.]+) kPa")


@dataclass(frozen=True)
class CaseResult:
    """A case and what has been found of it; nothing if it has not been run.

    Attributes
    ----------
    case, folder, scene_if_run
        Whose; None without a folder.
    axisymmetric, full3d
        Runs, coarsest first.
    rows
        Comparison rows of the scene, and what was measured in its axisymmetric states.
    modes_counted, crossings
        True if its axisymmetric states were counted by harmonic; where the counts change, of the finest counted run.
    """

    case: Case
    folder: Path = Path()
    scene_if_run: BellowsScene | None = None
    axisymmetric: tuple[Run, ...] = ()
    full3d: tuple[Run, ...] = ()
    rows: tuple[Row, ...] = ()
    modes_counted: bool = False
    crossings: tuple[FoundCrossing, ...] = ()

    @property
    def scene(self) -> BellowsScene:
        """BellowsScene of a case that has been run."""
        assert self.scene_if_run is not None
        return self.scene_if_run

    @property
    def runs(self) -> tuple[Run, ...]:
        """All runs."""
        return (*self.axisymmetric, *self.full3d)

    @property
    def pressures_kpa(self) -> Sequence[float]:
        """Requested pressures, kPa."""
        return self.scene.load.pressure_kpa if self.scene_if_run else ()

    def row(
        self,
        quantity: str,
        model: str = "axisymmetric",
        pressure_kpa: float | None = HIGHEST_KPA,
        level: str | None = None,
    ) -> Row:
        """Row of a quantity and a model at a pressure (kPa; None: any), of a level or of the finest."""
        return find(self.rows, quantity, model, pressure_kpa, level)

    def tip(self, model: str = "axisymmetric", pressure_kpa: float = HIGHEST_KPA, level: str | None = None) -> Row:
        """Elongation, as `row`."""
        return self.row(TIP, model, pressure_kpa, level)

    def best_tip(self, pressure_kpa: float = HIGHEST_KPA) -> Row:
        """Elongation by full 3D, else by the axisymmetric model, if it reached a pressure (kPa): its last row."""
        found = (self.tip(model, pressure_kpa) for model in ("full3d", "axisymmetric"))
        return next(filter(is_known, found), no_row())


@dataclass(frozen=True)
class Four:
    """The four actuators of a set of dimensions, in the order of the paper's numbers.

    Attributes
    ----------
    label
        Name of the set.
    kind
        The fit it is a member of, a key of `CHAIN_OF`.
    cases
        What has been found of each.
    """

    label: str
    kind: str
    cases: tuple[CaseResult, ...]

    @property
    def chain(self) -> str:
        """Model of the closed form that its dimensions were inferred with."""
        return CHAIN_OF[self.kind]

    @property
    def was_run(self) -> bool:
        """True if there are runs of all four."""
        return all(case.axisymmetric for case in self.cases)


@dataclass(frozen=True, eq=False)
class PaperResults:
    """All cases that have been run, in the order of `studies.paper.cases`."""

    cases: tuple[CaseResult, ...]

    def of(self, *groups: Group) -> tuple[CaseResult, ...]:
        """Cases of some groups."""
        return tuple(c for c in self.cases if c.case.group in groups)

    def result_of(self, case: Case) -> CaseResult:
        """What has been found of a case."""
        return next((c for c in self.cases if c.case == case), CaseResult(case))

    def variant(self, base: str, group: Group, suffix: str = "") -> CaseResult:
        """The case of a group made from a scene, the one whose name ends so if there are several."""
        return self.result_of(next(c for c in cases(group) if c.base == base and c.scene.endswith(suffix)))

    def named(self, name: str) -> CaseResult:
        """An actuator's own case, of the reference set or of an alternate."""
        return self.result_of(next(c for c in cases("core", "alternates") if c.scene == name))

    def near_zigzag(self, name: str) -> CaseResult:
        """A reference actuator's case near the zigzag of the paper's figure 2."""
        return self.result_of(next(c for c in cases("zigzag") if c.base == f"zigzag/{name}"))

    @property
    def reference(self) -> Four:
        """The reference set."""
        return Four("reference", "corrected", tuple(map(self.named, REFERENCE_SCENES)))

    def drawn(self, *kinds: str) -> tuple[Four, ...]:
        """The drawn sets of some kinds of which all four actuators have been run."""
        by_label: dict[str, list[CaseResult]] = {}
        for case in self.of("sets"):
            by_label.setdefault(case.case.label, []).append(case)
        found = [
            Four(one.name, one.kind, tuple(by_label[one.name]))
            for one in DRAWN
            if one.kind in kinds and len(by_label.get(one.name, ())) == len(REFERENCE_SCENES)
        ]
        return tuple(four for four in found if four.was_run)

    def unfolding(self, base: str, model: str) -> Row:
        """Pressure (kPa) at which roots are unfolded; from the run to 30 kPa if that to 20 kPa ends before."""
        near, far = (self.variant(base, group).row("unfolding_kpa", model, None) for group in ("core", "beyond"))
        return near if is_known(near) or far.status == MISSING else far

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows of all cases."""
        return tuple(row for case in self.cases for row in case.rows)

    @property
    def summaries(self) -> list[RunSummary]:
        """All runs."""
        return [run.summary for case in self.cases for run in case.runs]


def read_results(folder: Path, chosen: Iterable[Case]) -> PaperResults:
    """What has been run of cases with their present content."""
    found = []
    for case in chosen:
        place = folder / case.name
        if (place / SCENE_FILE).exists():
            of = read_scene_folder(load_bellows(place / SCENE_FILE), place, current=True)
            rows = (*of.rows, *_measured(place, of))
            counted = [r.summary.level for r in of.axisymmetric if any(state.unstable_by_m for state in r.path)]
            crossings = read_crossings(place / f"axisymmetric-{counted[-1]}") if counted else []
            runs_ = (of.axisymmetric, of.full3d)
            if case.group == "sets":
                rows = tuple(_of_drawn(case, rows))
            found.append(CaseResult(case, place, of.scene, *runs_, rows, bool(counted), tuple(crossings)))
    return PaperResults(tuple(found))


def _measured(place: Path, result: SceneResult[BellowsScene]) -> list[Row]:
    """The measured rows of a case; kept beside its runs, for measuring some hundred states takes a minute."""
    hashes = [run.summary.content_hash for run in result.axisymmetric]
    key = content_key(hashes, sources=[Path(inspect.getfile(module)) for module in _MEASURING])
    return kept(
        place / "measured.json",
        key,
        list[Row],
        lambda: measured_rows.measured_rows(result.scene, result.axisymmetric, place),
    )


def _of_drawn(case: Case, rows: Sequence[Row]) -> Iterator[Row]:
    """Of a drawn set's rows those that are shown: of the finest mesh, and of the chain that it was inferred with."""
    finest = f"r{max(case.levels)}"
    chain = CHAIN_OF[case.label.partition("-")[0]]
    for entry in rows:
        highest = entry.pressure_kpa == HIGHEST_KPA and entry.quantity in _AT_HIGHEST
        if entry.quantity in _AT_ALL or highest or entry.quantity == "unfolding_kpa":
            if (entry.model, entry.level) == ("axisymmetric", finest) or (entry.quantity, entry.model) == (TIP, chain):
                yield entry


# --- rows -----------------------------------------------------------------------------------


def find(
    rows: Iterable[Row], quantity: str, model: str, pressure_kpa: float | None = None, level: str | None = None
) -> Row:
    """The last row of a quantity and a model (levels ascend, so the finest) at a pressure; if none, `no_row`."""
    found = no_row()
    for entry in rows:
        if entry.quantity == quantity and entry.model == model and level in (None, entry.level):
            if pressure_kpa is None or abs(entry.pressure_kpa - pressure_kpa) < 1e-9:
                found = entry
    return found


def no_row() -> Row:
    """A row of what has not been run; it has no number and shows as a dash."""
    return row("", "", "", math.nan, MISSING, math.nan, status=MISSING)


def is_known(entry: Row) -> bool:
    """True for a row with a number."""
    return math.isfinite(entry.value)


def means_something(entry: Row) -> bool:
    """True for a row with a number, except that of a closed form past its model."""
    return is_known(entry) and entry.status != FOLDED_BACK


def limit_kpa(entry: Row) -> float:
    """Up to which pressure (kPa) something was looked for and not found, from its row's status; NaN if unsaid."""
    found = _LIMIT.search(entry.status)
    return float(found[1]) if found else math.nan


# --- runs -----------------------------------------------------------------------------------


def last_kpa(run: Run) -> float:
    """Highest pressure of a run's states, kPa; 0 if it has none."""
    return max((state.pressure_kpa for state in run.path), default=0.0)


def ending(run: Run) -> str:
    """Why a run ended."""
    return run.summary.reason or "all requested pressures reached"


def modes(runs: Sequence[Run], pressure_kpa: float = HIGHEST_KPA) -> str:
    """Number of unstable modes of the finest run at a requested pressure (kPa); a dash where it was not counted."""
    state = runs[-1].at(pressure_kpa) if runs else None
    return MISSING if state is None or math.isnan(state.unstable_modes) else f"{state.unstable_modes:.0f}"


def common_levels(one: CaseResult, other: CaseResult) -> list[str]:
    """Axisymmetric meshes that both cases have, the finest first."""
    have = {run.summary.level for run in other.axisymmetric}
    return [run.summary.level for run in reversed(one.axisymmetric) if run.summary.level in have]
