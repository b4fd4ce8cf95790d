"""Users' meshes of bodies with exact answers: every kind of cells, and an axis found by where it is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from analytical.exact import sphere
from analytical.exact import tube as exact_tube
from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.solid import FACETS
from studies.results.rows import read_rows
from studies.scene.load import load_scene
from studies.scene.materials import law_of

# Half a hollow sphere 5/7 mm: the meridian in gmsh's plane z = 0, its axis the curve at x = 0.
SPHERE = """Point(1) = {{0, 0, 0}}; Point(2) = {{5, 0, 0}}; Point(3) = {{7, 0, 0}};
Point(4) = {{{off}, 7, 0}}; Point(5) = {{{off}, 5, 0}};
Line(1) = {{2, 3}}; Circle(2) = {{3, 1, 4}}; Line(3) = {{4, 5}}; Circle(4) = {{5, 1, 2}};
Curve Loop(1) = {{1, 2, 3, 4}}; Plane Surface(1) = {{1}};
Mesh.CharacteristicLengthMax = 0.8; Mesh.ElementOrder = 2;
Physical Curve("symmetry_z") = {{1}}; Physical Curve("cavity") = {{4}}; Physical Surface("wall") = {{1}};
"""
QUADRILATERALS = "Mesh.RecombineAll = 1; Mesh.SubdivisionAlgorithm = 1;\n"


def answers(run, scene, tmp_path, quantity: str = "displacement_max_mm"):
    """Rows of a quantity, coarsest first."""
    out = tmp_path / "out"
    result = run("solve", scene, "--out", out)
    assert result.exit_code == 0, result.output
    return [row for row in read_rows(out / "rows.csv") if row.quantity == quantity]


def sphere_bore_mm(scene) -> float:
    law = law_of(load_scene(scene).material)
    return sphere.inner_radius_at_pressure_mm(sphere.Sphere(5.0, 7.0), law, 5e-3) - 5.0


def axis_of(path):
    """Radii of the nodes of the axis, and its length."""
    mesh = read_user_mesh(path)
    ends = mesh.points[mesh.facets[mesh.facet_tags == FACETS["axis"]]]
    return ends[:, :, 0], np.abs(np.diff(ends[:, :, 1], axis=1)).sum()


@pytest.mark.parametrize("cells", ["", QUADRILATERALS], ids=["triangles", "quadrilaterals"])
@pytest.mark.parametrize(
    ("off", "name"), [("0", ""), ("0", "outer"), ("0", "symmetry_x"), ("1e-6", ""), ("-1e-6", "axis"), ("5e-5", "")]
)
def test_an_axis_is_found_by_where_it_is(by_gmsh, scene, run, tmp_path, cells: str, off: str, name: str) -> None:
    named = f'Physical Curve("{name}") = {{3}};\n' if name else ""
    radii, length = axis_of(by_gmsh(SPHERE.format(off=off) + cells + named, dimension=2))
    assert (radii == 0.0).all()
    assert length == pytest.approx(2.0, abs=1e-9)
    if off == "5e-5" or (cells and name == "symmetry_x"):  # one of each kind is solved
        rows = answers(run, scene, tmp_path)
        assert [row.level for row in rows] == ["m1", "m2"]
        exact = sphere_bore_mm(scene)
        assert rows[-1].value == pytest.approx(exact, rel=1e-4)
        # ± holds the exact answer but for the shape of the given mesh: arcs of 7 degrees in parabolas
        assert all(abs(row.value - exact) <= row.uncertainty + 1e-5 * exact for row in rows)


@pytest.mark.parametrize(
    ("off", "name", "said"),
    [
        ("0", "clamped", "edges named 'clamped' lie on r = 0, which is the axis"),
        ("0", "tip", "edges named 'tip' lie on r = 0"),
        ("0.004", "", "an edge without a name reaches r = 0.004 mm, beside the axis r = 0"),
        ("0.02", "axis", "an edge named 'axis' reaches r = 0.02 mm, beside the axis r = 0"),
        ("-0.001", "", "this one reaches x = -0.001"),
    ],
)
def test_axes_that_are_none_are_refused(by_gmsh, refused, off: str, name: str, said: str) -> None:
    named = f'Physical Curve("{name}") = {{3}};\n' if name else ""
    by_gmsh(SPHERE.format(off=off) + named, dimension=2)
    assert said in refused()


def test_a_body_that_touches_the_axis_in_a_point_is_refused(written, refused) -> None:
    points = np.array([[0.0, 2.0, 0], [2.0, 0.0, 0], [4.0, 2.0, 0], [2.0, 4.0, 0]])
    written(points, {"cavity": (1, 1, [[0, 1]]), "symmetry_z": (1, 1, [[1, 2]]), "wall": (2, 3, [[0, 1, 2, 3]])})
    assert "the body touches r = 0 in a point, near z = 2 mm" in refused()


@pytest.mark.parametrize("hexahedra", [False, True], ids=["tetrahedra", "hexahedra"])
def test_quarter_of_a_tube(by_gmsh, tube, scene, run, tmp_path, hexahedra: bool) -> None:

    by_gmsh(tube["shape"] + (tube["hexahedra"] if hexahedra else "") + tube["names"] + tube["wall"])
    rows = answers(run, scene, tmp_path)
    law = law_of(load_scene(scene).material)
    exact = exact_tube.inner_radius_at_pressure_mm(exact_tube.Tube(5.0, 7.0), law, 5e-3) - 5.0
    assert [row.level for row in rows] == ["m1", "m2"]
    for row in rows:
        assert row.value == pytest.approx(exact, rel=1e-3)
        assert abs(row.value - exact) <= row.uncertainty + 1e-4 * exact
    assert rows[-1].uncertainty < 2e-3 * exact


@pytest.mark.parametrize("kind", ["8-node hexahedra", "4-node tetrahedra"])
def test_first_order_cells_with_flat_faces_are_solved_in_second_order(
    written, blocks, scene, run, tmp_path, kind: str
) -> None:
    points, cells = blocks[0]((2, 1, 2))
    low = {"symmetry_z": 2, "symmetry_x": 0, "symmetry_y": 1}
    sides = [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    faces = np.vstack([cells[:, list(side)] for side in sides])

    def on(axis: int, at: float) -> np.ndarray:
        return faces[(np.abs(points[faces][:, :, axis] - at) < 1e-9).all(axis=1)]

    groups: dict[str, Any] = {name: (2, 3, on(axis, 0.0)) for name, axis in low.items()} | {
        "cavity": (2, 3, on(0, 4.0))
    }
    groups["wall"] = (3, 5, cells)
    if kind == "4-node tetrahedra":
        # all cut along the same way: the three tetrahedra on either side of the diagonal 0-6
        cut = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
        split = np.vstack([cells[:, list(corners)] for corners in cut])
        triangles = {frozenset(t) for c in split.tolist() for t in (c[:3], c[1:], c[:2] + c[3:], c[:1] + c[2:])}
        for name, (dim, _, quads) in list(groups.items())[:-1]:
            halves = [h for q in quads.tolist() for h in (q[:3], q[1:], [q[0], q[1], q[3]], [q[0], q[2], q[3]])]
            groups[name] = (dim, 2, [h for h in halves if frozenset(h) in triangles])
        groups["wall"] = (3, 4, split)
    written(points, groups)
    rows = answers(run, scene, tmp_path)
    # pressed with 5 kPa of true pressure: mu (l^2 - 1/l) = -p, and the far corner moves the most
    stretch = brentq(lambda s: 75.0 * (s**2 - 1.0 / s) + 5.0, 0.5, 1.0)
    moved = np.array([4.0, 2.0, 4.0]) * np.array([stretch - 1.0] + [stretch**-0.5 - 1.0] * 2)
    for row in rows:
        assert row.value == pytest.approx(math.sqrt(moved @ moved), rel=1e-6)


def test_a_tolerance_is_met_on_divided_cells(by_gmsh, scene, run, tmp_path, monkeypatch) -> None:
    by_gmsh(SPHERE.format(off="0"), dimension=2)
    text = scene.read_text(encoding="utf-8") + "tolerance_percent = 0.002\n"
    scene.write_text(text, encoding="utf-8")
    rows = answers(run, scene, tmp_path)
    assert [row.level for row in rows] == ["m1", "m2", "m4", "m8"][: len(rows)]
    assert len(rows) > 2
    exact = sphere_bore_mm(scene)
    assert rows[0].uncertainty > 2e-5 * exact > rows[-1].uncertainty
    # the shape of the given mesh stays: parabolas for arcs, 1e-6 of the radius
    assert all(abs(row.value - exact) <= row.uncertainty + 1e-5 * exact for row in rows)
    monkeypatch.setattr("studies.planning.bodies.MOST_UNKNOWNS", {"axisymmetric": 1000, "full3d": 1000})
    planned = run("plan", scene).output
    assert "m2" not in planned
    assert "a refined mesh, without which ± is not known" in planned
