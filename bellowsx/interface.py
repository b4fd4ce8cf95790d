"""A scene, its solution, and that as a data frame or a figure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomlkit
from mpi4py import MPI

from studies.models.session import SceneResult, run_plan
from studies.planning.levels import Model
from studies.planning.planner import describe, make_plan
from studies.progress import Progress
from studies.results.rows import Row
from studies.scene import load
from studies.scene.text import changed_text

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Scene:
    """A checked scene; make one with `read` or `of`.

    Attributes
    ----------
    checked
        What the keys say (`studies.scene.bellows.BellowsScene` or `studies.scene.bodies.BodyScene`).
    text
        The same as a TOML file.
    place
        Folder in which the file of a user's mesh is looked for.
    """

    checked: load.Scene
    text: str
    place: Path

    @classmethod
    def read(cls, path: str | Path) -> Scene:
        """Read a scene file.

        Raises
        ------
        SceneError
            With one line per fault.
        """
        file = Path(path)
        return cls(load.load_scene(file), file.read_text(encoding="utf-8"), file.resolve().parent)

    @classmethod
    def of(cls, name: str, **tables: Mapping[str, Any]) -> Scene:
        """Make a scene from its tables: ``geometry``, ``material``, ``load``, and what else a scene file may have.

        Raises
        ------
        SceneError
            With one line per fault.
        """
        return cls._from_text(tomlkit.dumps({"name": name, **tables}), Path.cwd())

    def changed(self, name: str, changes: Mapping[str, Any]) -> Scene:
        """The same scene under another name with other values: ``{"geometry.wall_mm": 1.5}``.

        Raises
        ------
        SceneError
            With one line per fault.
        """
        return self._from_text(changed_text(self.text, name, changes), self.place)

    @classmethod
    def _from_text(cls, text: str, place: Path) -> Scene:
        return cls(load.scene_from(tomlkit.parse(text).unwrap(), place / "scene"), text, place)

    def plan(self, model: Model | None = None) -> str:
        """What `solve` would do, what it would skip, and why."""
        return describe(self.checked, make_plan(self.checked, model))


@dataclass(frozen=True)
class Answer:
    """What came out of a scene.

    Attributes
    ----------
    result
        Runs and rows.
    folder
        Where they are kept: ``rows.csv``, ``path.csv``, ``summary.json``, and fields for ParaView if they were asked.
    """

    result: SceneResult[load.Scene]
    folder: Path

    @property
    def reached(self) -> bool:
        """True if all requested loads were reached within the tolerance."""
        return self.result.reached and not self.result.missed

    @property
    def reason(self) -> str:
        """Why not; empty if they were."""
        return self.result.reason

    @property
    def warnings(self) -> tuple[str, ...]:
        """What looks wrong with the scene or the answer, a sentence each."""
        return self.result.warnings

    @property
    def rows(self) -> tuple[Row, ...]:
        """Comparison rows, all models and meshes."""
        return self.result.rows

    def frame(self) -> pandas.DataFrame:
        """The rows as a data frame, a column per column of rows.csv."""
        import pandas

        return pandas.DataFrame([asdict(row) for row in self.rows])

    def figure(self) -> Figure:
        """Elongation, or the force at a blocked tip, over pressure: all models, with the printed points if any."""
        from studies.report.scene_page import report_of
        from studies.report.scenes import elongation_figure

        return elongation_figure(report_of(self.folder))


def solve(scene: Scene, folder: str | Path, model: Model | None = None) -> Answer:
    """Solve a scene as ``bellowsx solve`` does; under ``mpirun`` all ranks call it.

    Parameters
    ----------
    scene
        What is to be solved.
    folder
        Where results are kept. Those that are there already, of the same content, are not computed again.
    model
        ``closed_form``, ``axisymmetric``, ``sector`` or ``full3d``; default the cheapest that holds the tolerance.

    Returns
    -------
    Answer

    Raises
    ------
    SceneError
        If the model is not one of the scene's.
    SolverError, MeshError, GeometryError
        If the scene cannot be meshed or solved at all; a path that ends early is an answer that says so.
    """
    comm = MPI.COMM_WORLD
    plan = make_plan(scene.checked, model)
    return Answer(run_plan(scene.checked, scene.text, plan, Path(folder), comm, Progress(comm)), Path(folder))
