"""Contact of a bellows: what may touch what, when it is switched on, and what is told of a state with it.

A run is without contact until a converged state shows a gap that has closed; that state is dropped, and the step taken
anew with contact from the last open one.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from meshes.gaps import outlines
from meshes.solid import FACETS, FloatArray, SolidMesh
from meshes.surface import boundary_edges
from solvers.contact.contact import Contact
from solvers.contact.obstacles import RoundedBox
from solvers.contact.pairs import Against, ContactSettings, Facing, Line, PairReport, Stop, gauss_points
from solvers.paths.states import PathState
from solvers.problem import Problem
from solvers.state import State
from studies.models.gaps import GapMeter, Touch
from studies.results.csv_files import read_lines, write_lines
from studies.results.run_files import PathRow
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.materials import law_of

CONTACT_FILE = "contact.csv"
# Begins the note on where contact was switched on.
MODELLED = "contact modelled"
# Of the wall: deepest penetration of an accepted state, where the pressure begins, how far ahead pairs are known, and
# how deep an iteration may go. The penalty keeps penetrations well below the first. With a pressure that begins at a
# thousandth of the wall vacuum-t1-ri5 stopped on r2 at 1.98 kPa; with three it needs a fifth of the factorisations.
LIMIT, SMOOTHING, REACH, DEPTH = 0.01, 0.003, 0.2, 0.6
# Where corners are closer than this part of the wall, the gap is measured at Gauss points too.
NEAR = 0.25
# Penalty in initial shear moduli per wall: the pressures that silicone bellows carry are a fraction of the modulus, and
# make a depth of a thousandth of the wall (make study-contact).
STIFFNESS = 300.0
# A rigid section needs a normal everywhere: its edge at the seat, covered by the bonded wall, is rounded a little, mm.
SEAT_EDGE_MM = 0.05
# The wall is bonded up to the seat's edge and touches the ring there by construction: contact fades in over this,
# beside a narrow seat over half of its width.
FADE_MM = 0.5


def contact_settings(scene: BellowsScene, stiffness: float = STIFFNESS) -> ContactSettings:
    """The penalty of a scene; ``stiffness`` in initial shear moduli per wall."""
    wall = scene.geometry.wall_mm
    modulus = law_of(scene.material).initial_shear_modulus_mpa
    return ContactSettings(stiffness * modulus / wall, SMOOTHING * wall, DEPTH * wall, REACH * wall, LIMIT * wall)


def may_touch(scene: BellowsScene, row: PathRow) -> bool:
    """True if surfaces of a state are so near that contact may press, or if its gap is not known."""
    return not row.min_gap_mm > LIMIT * scene.geometry.wall_mm


def scene_contact(scene: BellowsScene, mesh: SolidMesh, problem: Problem, stiffness: float = STIFFNESS) -> Contact:
    """Contact of a scene's meridian: folds inside and outside, wall and rings, rings.

    Raises
    ------
    SolverError
        If the problem is not one of a meridian on one rank.
    """
    bonded = {tuple(f) for f in mesh.facets[mesh.facet_tags == FACETS["bond"]].tolist()}
    lines = []
    for outline in outlines(mesh):
        ends = np.sort(np.column_stack([outline.nodes[:-1:2], outline.nodes[2::2]]), axis=1)
        free = np.array([tuple(end) not in bonded for end in ends.tolist()])
        lines.append(Line(outline.nodes, outline.side, free))
    pairs: list[Against | Facing | Stop] = [Facing("folds inside", 0, 0), Facing("folds outside", 1, 1)]
    if scene.rings.model == "rigid":
        pairs += _ring_pairs(scene, gauss_points(mesh.points, lines[1].nodes))
    return Contact(
        problem.unknowns, mesh.points, lines, pairs, contact_settings(scene, stiffness), boundary_edges(mesh)
    )


def _ring_pairs(scene: BellowsScene, at: FloatArray) -> list[Against | Facing | Stop]:
    """The outside against every ring, and neighbouring rings; ``at`` are the outside's Gauss points."""
    shape, rings = shape_of(scene), scene.rings
    low, high = shape.seat_radius_mm, shape.seat_radius_mm + rings.height_mm
    pairs: list[Against | Facing | Stop] = []
    fade = min(FADE_MM, 0.5 * rings.seat_mm)
    for body, centre in enumerate(shape.crest_positions_mm.tolist()):
        section = RoundedBox(low, high, centre, 0.5 * rings.seat_mm, SEAT_EDGE_MM, rings.edge_radius_mm)
        away = np.clip((np.abs(at[..., 1] - centre) - 0.5 * rings.seat_mm) / fade, 0.0, 1.0)
        pairs.append(Against("wall and ring", 1, section, body, away**2 * (3.0 - 2.0 * away)))
    flat = math.pi * ((high - rings.edge_radius_mm) ** 2 - low**2)
    for lower in range(len(shape.crest_positions_mm) - 1):
        pairs.append(Stop("rings", lower, lower + 1, 2.0 * shape.half_pitch_mm - rings.seat_mm, flat))
    return pairs


class ContactWatch:
    """Measures the gap of each state of a meridian's run, and switches contact on when it has closed.

    Parameters
    ----------
    scene, mesh, problem
        The scene, its meridian and the problem on it.
    folder
        Where ``contact.csv`` is written.
    """

    def __init__(self, scene: BellowsScene, mesh: SolidMesh, problem: Problem, folder: Path) -> None:
        self._scene, self._mesh, self._problem, self._folder = scene, mesh, problem, folder
        self._meter = GapMeter(scene, mesh)
        self._contact: Contact | None = None
        self._measured: tuple[State, Touch] | None = None
        self._open = "0 kPa"
        self.possible = scene.contact.model == "auto" and scene.rings.model in ("rigid", "none")
        self.possible &= problem.element.displacement_degree == 2

    @property
    def modelled(self) -> bool:
        """True once contact is part of the problem."""
        return self._problem.contact is not None

    def switch_on(self) -> None:
        """Make contact part of the problem."""
        self._problem.contact = self._made()

    def _made(self) -> Contact:
        if self._contact is None:
            self._contact = scene_contact(self._scene, self._mesh, self._problem)
        return self._contact

    def measure(self, state: State) -> Touch:
        """The smallest gap of a state: at corners of the outline, and at all Gauss points where it is small there."""
        if self._measured is not None and self._measured[0] is state:
            return self._measured[1]
        touch = self._meter.measure(state)
        if self.possible and touch.gap.gap_mm < NEAR * self._scene.geometry.wall_mm:
            self._problem.set_state(state)
            closest = min(self._made().report(), key=lambda report: report.gap_mm)
            if self.modelled or closest.gap_mm < touch.gap.gap_mm:
                touch = Touch(replace(touch.gap, gap_mm=closest.gap_mm), closest.what)
        self._measured = (state, touch)
        return touch

    def touches(self, item: PathState) -> bool:
        """True if surfaces of a state touch and contact could be modelled."""
        pressing = LIMIT * self._scene.geometry.wall_mm if self.modelled else 0.0
        return self.possible and self.measure(item.state).gap.gap_mm <= pressing

    def accept(self, item: PathState, notes: list[str]) -> bool:
        """False, and contact is on from now, if the state is the first whose gap has closed."""
        if self.modelled or not self.possible:
            return True
        touch = self.measure(item.state)
        here = self._loads(item)
        if touch.gap.gap_mm > 0.0:
            self._open = here
            return True
        r, z = touch.gap.at_mm
        notes.append(
            f"{MODELLED} beyond {self._open}: {touch.between} touch first between {self._open} and {here}, near "
            f"r = {r:.2f}, z = {z:.2f} mm"
        )
        self.switch_on()
        return False

    def _loads(self, item: PathState) -> str:
        """A state's pressure, and its force while that is being brought on."""
        pressure = f"{1e3 * self._scene.load.sense * item.state.load_mpa:.4g} kPa"
        force, whole = 0.0 - item.end_force_n, self._scene.load.tip_force_n
        return pressure if not whole or math.isclose(force, whole) else f"{pressure} with {force:.4g} N"

    def write(self, item: PathState) -> None:
        """Add a requested state in contact to ``contact.csv``."""
        if self._problem.contact is None:
            return
        self._problem.set_state(item.state)
        pressure = 1e3 * self._scene.load.sense * item.state.load_mpa
        write_reports(self._folder / CONTACT_FILE, pressure, self._problem.contact.report())


def write_reports(path: Path, pressure_kpa: float, reports: tuple[PairReport, ...]) -> None:
    """Add a state's pairs to a table, in place of what is there for its pressure."""
    key = f"{pressure_kpa:.12g}"
    rows = [row for row in read_reports(path) if row["pressure_kpa"] != key]
    rows += [{"pressure_kpa": key, **{k: str(v) for k, v in asdict(report).items()}} for report in reports]
    header = ["pressure_kpa", "what", "gap_mm", "force_n", "places"]
    write_lines(path, header, ([row[name] for name in header] for row in rows))


def read_reports(path: Path) -> list[dict[str, str]]:
    """Rows of such a table; none if it is not there."""
    return read_lines(path) if path.exists() else []
