"""Actuators whose moulding core sat off the axis, in full 3D, and where their tips stand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from studies.engine import Setting
from studies.models.axisymmetric import run_axisymmetric
from studies.models.build import TipPose, tip_pose
from studies.models.full3d import run_full3d
from studies.planning.levels import BodyLevel
from studies.results import provenance
from studies.results.run_files import load_state
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, at_pressures, core_shift_mm
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

# How far the core sat off the axis, of the wall.
SHARES: Final = (0.0, 0.05, 0.10)


@dataclass(frozen=True)
class Actuator:
    """A scene's file and what is solved of it, coarsest mesh first; only the most eccentric core on all of them."""

    name: str
    file: str
    pressures_kpa: tuple[float, ...]
    levels: tuple[BodyLevel, ...]

    def scene(self, share: float) -> BellowsScene:
        """The scene with a core off the axis by a share of the wall."""
        base = at_pressures(load_bellows(provenance.ROOT / "scenes" / self.file), self.pressures_kpa)
        geometry = base.geometry.model_copy(update={"eccentricity": share})
        ask = base.ask.model_copy(update={"fields": False})
        name = f"{self.name}-e{100.0 * share:02.0f}"
        return base.model_copy(update={"name": name, "geometry": geometry, "ask": ask})


@dataclass(frozen=True)
class Body:
    """A run, and how its tip stands at the requested pressures that it reached, by kPa."""

    scene: BellowsScene
    level: BodyLevel
    folder: Path
    run: Run
    poses: Mapping[float, TipPose]

    @property
    def share(self) -> float:
        """How far the core sat off the axis, of the wall."""
        return self.scene.geometry.eccentricity

    def value(self, quantity: str, pressure_kpa: float) -> float:
        """``tip_mm``, ``tip_bend_deg``, ``tip_sideways_mm`` or ``unstable_modes``; NaN if it was not reached."""
        state, pose = self.run.at(pressure_kpa), self.poses.get(pressure_kpa)
        if state is None or pose is None:
            return math.nan
        values = {
            "tip_mm": state.tip_mm,
            "tip_bend_deg": pose.bend_deg,
            "tip_sideways_mm": pose.sideways_mm,
            "unstable_modes": state.unstable_modes,
        }
        return values[quantity]

    def longer_mm(self, centred: Body, pressure_kpa: float) -> float:
        """What its elongation has gained on that of a centred core."""
        return self.value("tip_mm", pressure_kpa) - centred.value("tip_mm", pressure_kpa)


def solve(actuator: Actuator, at: Setting) -> list[Body]:
    """All cores on the coarsest mesh, then the most eccentric on the others; every rank calls."""
    runs = [(share, actuator.levels[0]) for share in SHARES]
    runs += [(SHARES[-1], level) for level in actuator.levels[1:]]
    return [solve_body(actuator, share, level, at) for share, level in runs]


def solve_body(actuator: Actuator, share: float, level: BodyLevel, at: Setting) -> Body:
    """An actuator with one core on one mesh; every rank calls, rank 0 knows the poses."""
    scene, folder = actuator.scene(share), at.out / actuator.name
    centred, place = folder / f"axisymmetric-r{level.meridian}", folder / f"{scene.name}-{level.name}"
    run_axisymmetric(scene, level.meridian, centred, at.comm, at.progress)
    run = run_full3d(scene, "full3d", level, centred, place, at.comm, at.progress, ())
    poses = {}
    if at.comm.rank == 0:
        body = scene_body(scene_meridian(scene, level.meridian), "full3d", level.around, core_shift_mm(scene))
        for pressure in actuator.pressures_kpa:
            if saved := load_state(place, run.summary.content_hash, 1e-3 * pressure):
                poses[pressure] = tip_pose(body, saved[0])
    return Body(scene, level, place, run, poses)
