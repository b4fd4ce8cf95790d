"""``mesh`` of a solid: a closed tube from CAD and as STL listed, named, meshed, taken by a scene; all else refused."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.by_gmsh.cad import read_solid
from meshes.by_gmsh.child import environment
from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.quality import region_volumes_mm3
from meshes.solid import FACETS
from meshes.surface import surface_weights
from studies.results.rows import read_rows

# A tube 5/7 mm, 20 mm long, closed by a cap of 3 mm at z = 20.
_MAKE = """
import sys, gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
occ.cut([(3, occ.addCylinder(0, 0, 0, 0, 0, 20, 7))], [(3, occ.addCylinder(0, 0, 0, 0, 0, 17, 5))])
{more}
occ.synchronize()
gmsh.option.setNumber("Mesh.MeshSizeMax", 1.0)
if sys.argv[1].endswith(".stl"):
    gmsh.model.mesh.generate(2)
gmsh.write(sys.argv[1])
"""
TUBE_MM3 = math.pi * (49.0 * 20.0 - 25.0 * 17.0)
CAVITY_MM2 = math.pi * (10.0 * 17.0 + 25.0)


def made(path: Path, more: str = "") -> Path:
    command = [sys.executable, "-c", _MAKE.replace("{more}", more), str(path)]
    subprocess.run(command, check=True, env=environment(), timeout=100, stdout=subprocess.DEVNULL)
    return path


def numbers(path: Path, radius: float) -> str:
    """Surfaces whose nodes are within a radius, or as far from the axis if it is of a cylinder: those of the cavity."""
    found = []
    for surface in read_solid(path).surfaces:
        r = np.hypot(*np.moveaxis(surface.triangles[:, :, :2], 2, 0)).max()
        if r < radius and surface.triangles[:, :, 2].max() < 19.0:
            found.append(surface.number)
    return ",".join(map(str, found))


def flat_at(path: Path, z: float) -> str:
    found = [s.number for s in read_solid(path).surfaces if np.abs(s.triangles[:, :, 2] - z).max() < 1e-6]
    return ",".join(map(str, found))


def test_surfaces_are_listed_and_drawn(run, tmp_path: Path) -> None:
    result = run("mesh", made(tmp_path / "tube.step"), "--picture", tmp_path / "tube.png")
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.output.splitlines() if re.match(r"\s+\d+\s", line)]
    assert sorted(row[1] for row in rows) == ["cylinder", "cylinder", "plane", "plane", "plane"]
    areas = sorted(float(row[2]) for row in rows)
    exact = [math.pi * x for x in (24.0, 25.0, 49.0, 2 * 5 * 17.0, 2 * 7 * 20.0)]
    assert areas == pytest.approx(sorted(exact), rel=5e-3)
    # the normals of the planes point out of the solid: the cap's inside faces down into the cavity
    assert len(re.findall(r"\(0, 0, 17\)\s+\(0, 0, -1\)", result.output)) == 1
    assert len(re.findall(r"\(0, 0, 20\)\s+\(0, 0, 1\)", result.output)) == 1
    assert f"volume: {TUBE_MM3:.6g} mm³" in result.output
    assert (tmp_path / "tube.png").stat().st_size > 20_000


@pytest.mark.parametrize(
    ("ending", "volume", "area"), [(".step", 1e-4, 1e-4), (".brep", 1e-4, 1e-4), (".stl", 5e-3, 5e-3)]
)
def test_meshed_with_names_and_in_other_units(run, tmp_path: Path, ending: str, volume: float, area: float) -> None:
    # straight edges of 2 mm would lose 7e-3 of the cavity's area
    solid, out = made(tmp_path / f"tube{ending}"), tmp_path / "part.msh"
    named = ["--name", f"cavity={numbers(solid, 5.1)}", "--name", f"clamped={flat_at(solid, 0.0)}"]
    for scale in (1.0, 0.5):
        size = ["--size", 2.0 * scale, "--scale", scale, "--out", out]
        result = run("mesh", solid, *named, "--name", f"tip={flat_at(solid, 20.0)}", *size)
        assert result.exit_code == 0, result.output
        mesh = read_user_mesh(out)
        assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(scale**3 * TUBE_MM3, rel=volume)
        assert surface_weights(mesh, "cavity").sum() == pytest.approx(scale**2 * CAVITY_MM2, rel=area)
        assert mesh.points[mesh.facets[mesh.facet_tags == FACETS["tip"]]][:, :, 2] == pytest.approx(20.0 * scale)


def test_a_scene_takes_it(run, scene, tmp_path: Path) -> None:
    solid = made(tmp_path / "tube.step")
    named = ["--name", f"cavity={numbers(solid, 5.1)}", "--name", f"clamped={flat_at(solid, 0.0)}"]
    named += ["--name", f"rigid_end={flat_at(solid, 20.0)}"]
    result = run("mesh", solid, *named, "--size", 4.0, "--out", tmp_path / "part.msh")
    assert result.exit_code == 0, result.output
    assert re.search(r"surface rigid_end: \d+ facets, a rigid body", result.output)
    assert "surface bond" not in result.output
    result = run("solve", scene, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    (given, refined) = [r for r in read_rows(tmp_path / "out" / "rows.csv") if r.quantity == "displacement_max_mm"]
    assert abs(given.value - refined.value) <= refined.uncertainty < 0.01 * refined.value


def test_solids_that_touch_are_joined_and_parts_apart_refused(run, tmp_path: Path) -> None:
    def meshed(solid: Path, out: Path):
        named = ["--name", f"cavity={numbers(solid, 5.1)}", "--name", f"clamped={flat_at(solid, 0.0)}"]
        return run("mesh", solid, *named, "--size", 2.5, "--out", out)

    box = "occ.addBox(-1, -1, 20, 2, 2, 2)"
    result = meshed(made(tmp_path / "two.step", box), tmp_path / "two.msh")
    assert result.exit_code == 0, result.output
    assert re.search(r"volume body_1: \d+ cells\nvolume body_2: \d+ cells\n", result.output)
    assert region_volumes_mm3(read_user_mesh(tmp_path / "two.msh"))["elastomer"] == pytest.approx(
        TUBE_MM3 + 8.0, rel=1e-4
    )
    result = meshed(made(tmp_path / "apart.step", box.replace("20, 2", "21, 2")), tmp_path / "apart.msh")
    assert result.exit_code == 2
    assert "that do not touch" in result.output
    assert not (tmp_path / "apart.msh").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--name", "cavity=4,5"], "takes --name (cavity=NUMBERS at least), --size"),
        (["--size", 1.0, "--out", "part.msh"], "takes --name (cavity=NUMBERS at least), --size"),
        (["--name", "cavty=4", "--size", 1.0, "--out", "part.msh"], "'cavty' is unknown; allowed: cavity, clamped"),
        (["--name", "cavity=44", "--size", 1.0, "--out", "part.msh"], "no surface 44; there are 1, 2, 3, 4, 5"),
        (
            ["--name", "cavity=a", "--size", 1.0, "--out", "part.msh"],
            "give numbers of surfaces, as in --name cavity=1,2",
        ),
        (
            ["--name", "cavity=4", "--name", "tip=4", "--size", 1.0, "--out", "part.msh"],
            "surface 4 is named more than once",
        ),
        (["--name", "clamped=3", "--size", 1.0, "--out", "part.msh"], "no surface is named 'cavity'"),
        (["--name", "cavity=4", "--size", 99.0, "--out", "part.msh"], "--size 99: must be above 0 and at most"),
        (["--name", "cavity=4", "--size", 1.0, "--out", "part.vtu"], "give a name that ends in .msh"),
    ],
)
def test_refusals_write_nothing(run, tmp_path: Path, monkeypatch, options: list[object], said: str) -> None:
    monkeypatch.chdir(tmp_path)
    made(tmp_path / "tube.step")
    (tmp_path / "part.msh").write_text("kept", encoding="utf-8")
    result = run("mesh", "tube.step", *options)
    assert result.exit_code == 2
    assert said in result.output
    assert sorted(p.name for p in tmp_path.iterdir()) == ["part.msh", "tube.step"]
    assert (tmp_path / "part.msh").read_text(encoding="utf-8") == "kept"


TETRAHEDRON = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("open.stl", [(0, 2, 1), (0, 1, 3), (1, 2, 3)], "not closed: 3 edges belong to one triangle"),
        ("empty.stl", [], "gmsh cannot read a solid from it"),
        ("text.step", "this is no solid", "gmsh cannot read a solid from it"),
        ("part.msh", "this is no mesh", "is no gmsh mesh"),
    ],
)
def test_files_that_hold_no_solid(run, tmp_path: Path, name: str, content: Any, said: str) -> None:
    path = tmp_path / name
    if isinstance(content, str):
        path.write_text(content, encoding="ascii")
    else:
        corners = ["\n".join(f"vertex {x} {y} {z}" for x, y, z in (TETRAHEDRON[k] for k in face)) for face in content]
        facets = [f"facet normal 0 0 0\nouter loop\n{c}\nendloop\nendfacet" for c in corners]
        path.write_text("\n".join(["solid s", *facets, "endsolid s", ""]), encoding="ascii")
    result = run("mesh", path)
    assert result.exit_code == 2
    assert said in result.output
    assert list(tmp_path.iterdir()) == [path]


def test_surfaces_without_a_solid_are_refused(run, tmp_path: Path) -> None:
    path = made(
        tmp_path / "sheet.step", "occ.synchronize(); occ.remove(occ.getEntities(3)); occ.addRectangle(0, 0, 0, 9, 9)"
    )
    result = run("mesh", path)
    assert result.exit_code == 2
    assert "it holds no solid: export a solid body" in result.output
