"""What a user's mesh file may not hold: each refused before anything is solved, with what it holds and what is wanted.

Where a message names an option of gmsh, gmsh is run with that option and the mesh is taken.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.quality import region_volumes_mm3

SHIPPED = Path(__file__).resolve().parents[3] / "scenes" / "exact" / "octant.msh"
QUARTER_TUBE_MM3 = 6.0 * math.pi * 3.0


def volume_mm3(path: Path) -> float:
    return region_volumes_mm3(read_user_mesh(path))["elastomer"]


# --- kinds of cells -------------------------------------------------------------------------------------------


def test_tetrahedra_and_prisms(by_gmsh, tube, refused) -> None:
    low = tube["shape"].replace("0, 3, 7", "0, 1, 7").replace("0, 3, 5", "0, 1, 5")
    script = (
        low
        + "s() = Surface In BoundingBox {-1, -1, 0.9, 8, 8, 1.1}; "
        + ("Extrude {0, 0, 2} { Surface{s()}; Layers{2}; Recombine; }" + tube["names"] + tube["wall"])
    )
    by_gmsh(script)
    said = refused()
    assert re.search(r"holds \d+ 10-node tetrahedra and \d+ 18-node prisms", said)
    assert "extrude without Recombine" in said
    assert volume_mm3(by_gmsh(script.replace(" Recombine;", ""))) == pytest.approx(QUARTER_TUBE_MM3, rel=1e-4)


def test_pyramids_between_hexahedra_and_tetrahedra(written, blocks, refused) -> None:
    points, cells = blocks[0]((1, 1, 1))
    points = np.vstack([points, [[1.0, 1.0, 4.0], [1.0, 4.0, 3.0]]])
    groups = blocks[1](points[:8], cells) | {
        "pyramid": (3, 7, [[*cells[0, 4:], 8]]),
        "tetrahedron": (3, 4, [[cells[0, 7], cells[0, 6], 8, 9]]),
    }
    written(points, groups)
    said = refused()
    for held in ("1 8-node hexahedra", "1 5-node pyramids", "1 4-node tetrahedra"):
        assert held in said


def test_first_and_second_order_together(written, refused) -> None:
    mesh = read_user_mesh(SHIPPED)
    gmsh_order = mesh.cells[:, [0, 1, 2, 3, 9, 6, 8, 7, 4, 5]]
    cavity = mesh.facets[mesh.facet_tags == 1]
    written(
        mesh.points,
        {"cavity": (2, 2, cavity), "first": (3, 4, gmsh_order[:9, :4]), "second": (3, 11, gmsh_order[9:])},
    )
    assert "holds 9 4-node tetrahedra and 365 10-node tetrahedra" in refused()


@pytest.mark.parametrize(
    ("options", "hexahedra", "held", "option"),
    [
        ("Mesh.ElementOrder = 3;", False, r"\d+ 20-node tetrahedra, of order 3", "Mesh.ElementOrder = 2"),
        ("Mesh.SecondOrderIncomplete = 1;", True, r"\d+ 20-node hexahedra", "Mesh.SecondOrderIncomplete = 0"),
        ("Mesh.ElementOrder = 1;", False, r"first-order cells with \d+ bends of up to \d+", "Mesh.ElementOrder = 2"),
        ("Mesh.ElementOrder = 1;", True, r"first-order cells with \d+ bends of up to \d+", "Mesh.ElementOrder = 2"),
    ],
)
def test_one_kind_that_is_not_taken(
    by_gmsh, tube, refused, options: str, hexahedra: bool, held: str, option: str
) -> None:
    script = tube["shape"] + (tube["hexahedra"] if hexahedra else "") + tube["names"] + tube["wall"]
    by_gmsh(script + options)
    said = refused()
    assert re.search(held, said)
    assert option in said
    assert volume_mm3(by_gmsh(script + options + option + ";")) == pytest.approx(QUARTER_TUBE_MM3, rel=1e-4)


def test_no_volume(by_gmsh, tube, refused) -> None:
    by_gmsh(tube["shape"] + tube["names"])
    said = refused()
    assert re.search(r"holds \d+ 6-node triangles of a surface in space, and no cells of a volume", said)
    assert 'Physical Volume("body")' in said
    assert volume_mm3(by_gmsh(tube["shape"] + tube["names"] + "Mesh.SaveAll = 1;")) == pytest.approx(
        QUARTER_TUBE_MM3, rel=1e-4
    )


def test_volume_in_two_groups_of_format_2(by_gmsh, tube, refused) -> None:
    script = tube["shape"] + tube["names"] + tube["wall"] + tube["wall"].replace('"wall"', '"all"')
    by_gmsh(script + "Mesh.MshFileVersion = 2.2;")
    said = refused()
    assert re.search(r"(\d+) of \1 cells are there more than once", said)
    assert "Mesh.MshFileVersion = 4.1" in said
    assert volume_mm3(by_gmsh(script + "Mesh.MshFileVersion = 4.1;")) == pytest.approx(QUARTER_TUBE_MM3, rel=1e-4)


MERIDIAN = """SetFactory("OpenCASCADE"); Rectangle(1) = {2, 0, 0, 1, 4}; Mesh.ElementOrder = 2;
Mesh.CharacteristicLengthMax = 0.5;
Physical Curve("cavity") = {4}; Physical Curve("clamped") = {1}; Physical Surface("wall") = {1};"""


@pytest.mark.parametrize(
    ("moved", "said"),
    [
        ("Translate {0, 0, 3} { Surface{1}; }", "in the plane z = 3"),
        ("Rotate { {1, 0, 0}, {0, 0, 0}, Pi/2 } { Surface{1}; }", "in the plane y = 0"),
        ("Translate {-2.5, 0, 0} { Surface{1}; }", "this one reaches x = -0.5"),
    ],
)
def test_meridian_in_another_plane(by_gmsh, refused, moved: str, said: str) -> None:
    shape, names = MERIDIAN.split("Mesh.ElementOrder")
    by_gmsh(shape + moved + "\nMesh.ElementOrder" + names, dimension=2)
    assert said in refused()


def test_lines_alone(by_gmsh, refused) -> None:
    by_gmsh(MERIDIAN, dimension=1)
    said = refused()
    assert re.search(r"holds \d+ 3-node lines and no cells", said)
    assert "-2" in said


def test_triangles_and_quadrilaterals(written, refused) -> None:
    points = np.array([[2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0], [2.5, 2, 0]])
    written(points, {"cavity": (1, 1, [[3, 0]]), "q": (2, 3, [[0, 1, 2, 3]]), "t": (2, 2, [[3, 2, 4]])})
    said = refused()
    assert "1 3-node triangles and 1 4-node quadrilaterals" in said
    assert "Mesh.RecombineAll = 1 with Mesh.SubdivisionAlgorithm = 1" in said


# --- cells and nodes ------------------------------------------------------------------------------------------


def test_cells_numbered_the_other_way_round_are_turned_over(written, blocks) -> None:
    points, cells = blocks[0]((2, 1, 2))
    groups, turned = blocks[1](points, cells), cells.copy()
    turned[1:3] = turned[1:3][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    assert volume_mm3(written(points, {**groups, "wall": (3, 5, turned)})) == pytest.approx(32.0, rel=1e-12)


def test_folded_flat_and_degenerate_cells(written, blocks, refused) -> None:
    points, cells = blocks[0]((2, 1, 2))
    groups = blocks[1](points, cells)
    number = 1 + sum(len(nodes) for _, _, nodes in list(groups.values())[:2])
    folded = points.copy()
    folded[cells[0, 6]] += [-1.9, -1.9, -1.9]
    written(folded, groups)
    assert re.search(r"cell \d+ near .* is folded over or has a flat corner", refused())
    same = cells.copy()
    same[0, 1] = same[0, 0]
    written(points, {**groups, "wall": (3, 5, same)})
    assert re.search(rf"cell {number} near .* (is flat|flat corner)", refused())


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_coordinates_that_are_no_numbers(written, blocks, refused, value: float) -> None:
    points, cells = blocks[0]((2, 1, 1))
    groups = blocks[1](points, cells)
    points[5, 1] = value
    written(points, groups)
    assert re.search(r"node 6 is at \(.*(nan|inf).*\): 1 nodes have coordinates that are no finite numbers", refused())


def test_nodes_that_no_cell_uses_are_left_out(written, blocks) -> None:
    points, cells = blocks[0]((1, 1, 1))
    groups = blocks[1](points, cells)
    assert volume_mm3(written(np.vstack([points, [[1e9, 0.0, 0.0]]]), groups)) == pytest.approx(8.0, rel=1e-12)


# --- names ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('"cavity"', '"cavty"'), "physical surface 'cavty' is unknown; did you mean cavity"),
        (('"cavity"', '"Clamped"'), "physical surface 'Clamped' is unknown; did you mean clamped"),
        (('"cavity"', '"tip"'), "no physical surface is named 'cavity', where the pressure acts; named are:"),
        (('2 2 "cavity"', '3 2 "cavity"'), "physical surface 2 has no name"),
        (('"clamped"', '"axis"'), "'axis' is a meridian's line r = 0"),
        (('"clamped"', '"symmetry_x"'), "'symmetry_x' keeps x on planes x = const, and is tilted by"),
    ],
)
def test_names(written, blocks, refused, change: tuple[str, str], said: str) -> None:
    points, cells = blocks[0]((2, 1, 1))
    path = written(points, blocks[1](points, cells))
    path.write_text(path.read_text(encoding="ascii").replace(*change), encoding="ascii")
    assert said in refused()


def test_groups_that_hold_nothing(written, blocks, refused) -> None:
    points, cells = blocks[0]((2, 1, 1))
    path = written(points, blocks[1](points, cells))
    text = path.read_text(encoding="ascii")
    path.write_text(text.replace("$PhysicalNames\n3\n", '$PhysicalNames\n4\n2 9 "outer"\n'), encoding="ascii")
    assert "physical surface 'outer' holds nothing" in refused()


def test_named_facets_inside_and_twice(written, blocks, refused) -> None:
    points, cells = blocks[0]((2, 1, 2))
    groups = blocks[1](points, cells)
    inside = cells[points[cells][:, :, 2].min(axis=1) == 2.0][:, :4]
    written(points, {**groups, "outer": (2, 3, inside)})
    assert "2 facets named 'outer' are not on the boundary of the cells" in refused()
    written(points, {**groups, "tip": groups["cavity"]})
    assert "a facet has 2 names (cavity, tip), and 2 facets in all" in refused()


def test_volumes_are_asked_for_only_where_they_are_enclosed(by_gmsh, tube, scene, refused, run) -> None:
    names = tube["names"] + tube["wall"]
    wider = names.replace("8, 8", "10, 8").replace("8, 0.1, 4", "10, 0.1, 4").replace("5.1, 5.1", "7.1, 5.1")
    aside = wider.replace("{-0.1, -1, -1, 0.1", "{1.9, -1, -1, 2.1")
    by_gmsh(tube["shape"] + "Translate {2, 0, 0} { Volume{3}; }\n" + aside)
    planned = run("plan", scene)
    assert planned.exit_code == 0, planned.output
    text = scene.read_text(encoding="utf-8")
    scene.write_text(text.replace('"displacement_max_mm"', '"volume_mm3"'), encoding="utf-8")
    assert "the cavity ends near (2, 5, " in refused()  # on the plane of symmetry x = 2
    by_gmsh(tube["shape"] + names)
    assert run("plan", scene).exit_code == 0


# --- files ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: "", "is no gmsh mesh, which begins with $MeshFormat"),
        (lambda t: "solid cube\nfacet normal 0 0 1\n", "holds a shape and no mesh"),
        (lambda t: "*HEADING\n*NODE\n1, 0., 0., 0.\n", "is no gmsh mesh"),
        (lambda t: t[: len(t) // 3], "ends before $EndNodes: it was cut off"),
        (lambda t: t[: -len("$EndElements\n")], "ends before $EndElements: it was cut off"),
        (lambda t: t[: t.index("$Elements")], "has no section $Elements"),
        (lambda t: t.replace("$Elements\n6\n", "$Elements\n5\n"), "declares 5 elements and holds 6"),
        (lambda t: t.replace("\n6 5 2 3", "\n5 5 2 3"), "declares 6 elements, of which gmsh took 5"),
        (lambda t: t.replace("$Elements\n6\n", "$Elements\nsix\n"), "its $MeshFormat or $Elements cannot be read"),
        (lambda t: t.replace("\n6 5 2 3 3 ", "\n6 5 2 3 3 99"), "gmsh cannot read it (exit 1): Wrong node index 99"),
        (lambda t: t.replace("\n6 5 2 3 3", "\n6 77 2 3 3"), "(exit 1): Unknown type of element 77"),
    ],
)  # fmt: skip
def test_files_that_are_no_whole_meshes(written, blocks, refused, change, said: str) -> None:
    points, cells = blocks[0]((2, 1, 1))
    path = written(points, blocks[1](points, cells))
    text = path.read_text(encoding="ascii")
    path.write_text(change(text), encoding="ascii")
    assert change(text) != text
    assert said in refused()


def test_scripts_of_gmsh_are_not_run(scene, refused, tmp_path) -> None:
    scene.write_text(scene.read_text(encoding="utf-8").replace("part.msh", "part.geo"), encoding="utf-8")
    (tmp_path / "part.geo").write_text(f'Point(1) = {{0, 0, 0}}; SystemCall "touch {tmp_path}/ran";', encoding="utf-8")
    assert "is a script of gmsh: mesh it first with: gmsh -3 -order 2 part.geo -o part.msh" in refused()
    (tmp_path / "part.geo").unlink()
    assert "cannot be read (No such file or directory)" in refused()
    (tmp_path / "part.geo").mkdir()
    assert "cannot be read (Is a directory)" in refused()


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_binary_files_are_read_and_cut_ones_refused(by_gmsh, tube, refused, version: str) -> None:
    script = tube["shape"] + tube["names"] + tube["wall"] + f"Mesh.MshFileVersion = {version};"
    text = volume_mm3(by_gmsh(script, name="text.msh"))
    path = by_gmsh(script + "Mesh.Binary = 1;")
    assert volume_mm3(path) == pytest.approx(text, rel=1e-12)
    content = path.read_bytes()
    path.write_bytes(content[: int(0.8 * len(content))])
    assert "it was cut off" in refused()
