"""Scenes on users' mesh files: made by gmsh from a script of it, or written by hand, a change at a time."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from meshes.by_gmsh.child import environment
from studies.__main__ import main

SCENE = """name = "users"
[geometry]
kind = "mesh"
file = "part.msh"
[material]
law = "neo-hooke"
mu_kpa = 75.0
[load]
pressure_kpa = [5.0]
[ask]
quantities = ["displacement_max_mm"]
"""
_CHILD = """
import sys, gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open(sys.argv[1])
if int(sys.argv[3]):
    gmsh.model.mesh.generate(int(sys.argv[3]))
gmsh.write(sys.argv[2])
"""
# A quarter of a tube 5/7 mm, 3 mm long: volume 3, its named surfaces where {parts} says which volumes there are.
TUBE = """SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 3, 7, Pi/2}; Cylinder(2) = {0, 0, 0, 0, 0, 3, 5, Pi/2};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.CharacteristicLengthMax = 1.5; Mesh.ElementOrder = 2; Mesh.MshFileVersion = 4.1;
"""
TUBE_NAMES = """
Physical Surface("bottom") = Surface In BoundingBox {-1, -1, -0.1, 8, 8, 0.1};
Physical Surface("top") = Surface In BoundingBox {-1, -1, 2.9, 8, 8, 3.1};
Physical Surface("symmetry_x") = Surface In BoundingBox {-0.1, -1, -1, 0.1, 8, 4};
Physical Surface("symmetry_y") = Surface In BoundingBox {-1, -0.1, -1, 8, 0.1, 4};
Physical Surface("cavity") = Surface In BoundingBox {-0.1, -0.1, -0.1, 5.1, 5.1, 3.1};
"""
WALL = 'Physical Volume("wall") = Volume In BoundingBox {-1, -1, -1, 8, 8, 4};\n'
# Transfinite hexahedra of the same tube: 8 round, 2 through, 2 along.
HEXAHEDRA = """
Transfinite Curve{:} = 3;
round() = Curve In BoundingBox {-0.1, -0.1, -0.1, 7.1, 7.1, 0.1};
top() = Curve In BoundingBox {-0.1, -0.1, 2.9, 7.1, 7.1, 3.1};
For i In {0 : #round() - 1} b() = BoundingBox Curve{round(i)}; If (b(3) - b(0) > 3 && b(4) - b(1) > 3)
Transfinite Curve{round(i)} = 9; EndIf EndFor
For i In {0 : #top() - 1} b() = BoundingBox Curve{top(i)}; If (b(3) - b(0) > 3 && b(4) - b(1) > 3)
Transfinite Curve{top(i)} = 9; EndIf EndFor
Transfinite Surface{:}; Recombine Surface{:}; Transfinite Volume{:};
"""


@pytest.fixture
def by_gmsh(tmp_path: Path) -> Callable[..., Path]:
    """Path of a mesh that gmsh makes of a script; of dimension 0 it meshes nothing."""

    def make(script: str, dimension: int = 3, name: str = "part.msh") -> Path:
        geo, out = tmp_path / "part.geo", tmp_path / name
        geo.write_text(script + "\n", encoding="utf-8")
        command = [sys.executable, "-c", _CHILD, str(geo), str(out), str(dimension)]
        subprocess.run(command, check=True, env=environment(), timeout=100)
        return out

    return make


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., Path]:
    """Path of a file of format 2.2 with nodes, elements and named groups as given."""

    def write(points: np.ndarray, groups: Mapping[str, tuple[int, int, np.ndarray]], name: str = "part.msh") -> Path:
        """``groups``: name -> dimension, gmsh's type, nodes counted from 0."""
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
        lines += [f'{dim} {k + 1} "{group}"' for k, (group, (dim, _, _)) in enumerate(groups.items())]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(points))]
        lines += [f"{k + 1} {' '.join(map(repr, p))}" for k, p in enumerate(np.asarray(points, dtype=float).tolist())]
        lines += ["$EndNodes", "$Elements", str(sum(len(nodes) for _, _, nodes in groups.values()))]
        number = 0
        for k, (_, kind, nodes) in enumerate(groups.values()):
            for row in (np.asarray(nodes) + 1).tolist():
                number += 1
                lines.append(f"{number} {kind} 2 {k + 1} {k + 1} {' '.join(map(str, row))}")
        path = tmp_path / name
        path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="ascii")
        return path

    return write


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene on ``part.msh`` beside it."""
    path = tmp_path / "scene.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def _run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture
def run() -> Callable[..., Result]:
    """The command line."""
    return _run


@pytest.fixture
def refused(scene: Path, tmp_path: Path) -> Callable[[], str]:
    """What ``solve`` says when it refuses the scene; ``plan`` says the same, and nothing is written or overwritten."""

    def ask() -> str:
        out = tmp_path / "out"
        out.mkdir(exist_ok=True)
        (out / "path.csv").write_text("kept", encoding="utf-8")
        before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")}
        result, planned = _run("solve", scene, "--out", out), _run("plan", scene)
        assert result.exit_code == planned.exit_code == 2, result.output
        assert result.output == planned.output
        assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")} == before
        assert "geometry.file: " in result.output or "ask.quantities = " in result.output
        return result.output.replace(str(tmp_path), "")

    return ask


@pytest.fixture
def tube() -> dict[str, str]:
    """Parts of gmsh scripts of a quarter of a tube."""
    return {"shape": TUBE, "names": TUBE_NAMES, "wall": WALL, "hexahedra": HEXAHEDRA}


def block(cells: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and 8-node hexahedra, in gmsh's order, of a block of cubes of 2 mm."""
    nx, ny, nz = (n + 1 for n in cells)
    points = 2.0 * np.stack(np.meshgrid(range(nx), range(ny), range(nz), indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(nx * ny * nz).reshape(nx, ny, nz)
    parts = [
        number[i : nx - 1 + i, j : ny - 1 + j, k : nz - 1 + k].ravel()
        for k in (0, 1)
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    return points, np.stack(parts, axis=1)


def block_groups(points: np.ndarray, cells: np.ndarray) -> dict[str, tuple[int, int, np.ndarray]]:
    """A block as groups of a file: clamped below, pressed on above."""
    sides = {"clamped": (cells[:, :4], points[:, 2].min()), "cavity": (cells[:, 4:], points[:, 2].max())}
    named = {
        name: (2, 3, faces[(np.abs(points[faces][:, :, 2] - z) < 1e-9).all(axis=1)])
        for name, (faces, z) in sides.items()
    }
    return {**named, "wall": (3, 5, cells)}


@pytest.fixture
def blocks() -> tuple[Callable[..., object], Callable[..., object]]:
    """`block` and `block_groups`."""
    return block, block_groups
