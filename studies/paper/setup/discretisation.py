"""Elements and meshes of the finite-element models."""

from __future__ import annotations

from typing import Final

from solvers.discrete.elements import usual_element
from studies.paper.cases import REFERENCE
from studies.paper.setup.sizes import called, scene_of
from studies.planning.levels import MERIDIANS
from studies.report.labels import level_label
from studies.report.numbers import count
from studies.report.tables import Table
from studies.scene.meshes import scene_meridian, scene_resolution

# Models by their cells.
CELLS: Final = {
    "quadrilateral": ("axisymmetric", "quadrilaterals of 9 nodes"),
    "hexahedron": ("full 3D", "hexahedra of 27 nodes"),
    "triangle": ("axisymmetric beside tetrahedra, and with meshed rings", "triangles of 6 nodes"),
    "tetrahedron": ("full 3D, tetrahedra", "tetrahedra of 10 nodes, as in the paper"),
}
_PRESSURES: Final = {
    "continuous": "linear, continuous",
    "linear": "linear in each cell, with jumps between cells",
    "constant": "constant in each cell",
}


def elements() -> Table:
    """Cells and spaces of displacement and pressure of each model."""
    lines = []
    for cell, (model, cells) in CELLS.items():
        element = usual_element(cell)
        degree = {1: "linear", 2: "quadratic"}[element.displacement_degree]
        lines.append((model, cells, degree, _PRESSURES[element.pressure], element.name))
    return Table(("model", "cells", "displacement", "pressure", "name"), tuple(lines), left=(0, 1, 2, 3, 4))


def meridians() -> Table:
    """Cells through the wall, and cells in all, of the four actuators' meridians."""
    scenes = [scene_of(actuator.name) for actuator in REFERENCE]
    lines = []
    for level in MERIDIANS:
        through = [scene_resolution(scene, level).through * level for scene in scenes]
        cells = [len(scene_meridian(scene, level).cells) for scene in scenes]
        sizes = (f"{t} / {count(c)}" for t, c in zip(through, cells, strict=True))
        lines.append((level_label(f"r{level}"), *sizes))
    return Table(("cells through the wall / in all", *map(called, REFERENCE)), tuple(lines))
