"""Files whose cells do not make one body: parts not joined, in pieces, slit, pinched, twice over or overlapping."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.quality import region_volumes_mm3

QUARTER_TUBE_MM3 = 6.0 * math.pi * 3.0


def volume_mm3(path: Path) -> float:
    return region_volumes_mm3(read_user_mesh(path))["elastomer"]


def test_parts_that_touch_and_are_not_joined(by_gmsh, tube, refused) -> None:
    first = tube["shape"].replace("0, 3, 7", "0, 1.5, 7").replace("0, 3, 5", "0, 1.5, 5")
    second = """Cylinder(11) = {0, 0, 1.5, 0, 0, 1.5, 7, Pi/2}; Cylinder(12) = {0, 0, 1.5, 0, 0, 1.5, 5, Pi/2};
    BooleanDifference(13) = { Volume{11}; Delete; }{ Volume{12}; Delete; };
    """
    names = tube["names"] + tube["wall"]
    unglued = by_gmsh(first + second + names)
    said = refused()
    assert re.search(
        r"in 2 parts of \d+, \d+ cells that touch and are not joined \(\d+ pairs of nodes in one place", said
    )
    for way in ("BooleanFragments{ Volume{:}; Delete; }{}", "Coherence Mesh", "removeDuplicateNodes"):
        assert way in said
    joined = by_gmsh(f'Merge "{unglued}"; Coherence Mesh;', dimension=0, name="joined.msh")
    fragments = by_gmsh(first + second + "BooleanFragments{ Volume{:}; Delete; }{}" + names)
    for mended in (joined, fragments):
        assert volume_mm3(mended) == pytest.approx(QUARTER_TUBE_MM3, rel=1e-4)


BOXES = """SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 4, 4, 1}; Box(2) = {1.3, 1.1, 1, 1.5, 1.6, 2};
Mesh.ElementOrder = 2; Mesh.CharacteristicLengthMax = 0.9;
"""
BOX_NAMES = """
Physical Surface("clamped") = Surface In BoundingBox {-1, -1, -0.1, 5, 5, 0.1};
Physical Surface("cavity") = Surface In BoundingBox {-1, -1, 2.9, 5, 5, 3.1};
Physical Volume("wall") = Volume In BoundingBox {-1, -1, -1, 5, 5, 5};
"""


def test_parts_that_touch_with_other_nodes(by_gmsh, refused) -> None:
    by_gmsh(BOXES + BOX_NAMES)
    said = refused()
    assert re.search(r"in 2 parts .* touch and are not joined \(\d+ facets on others whose nodes are elsewhere", said)
    fragments = "BooleanFragments{ Volume{:}; Delete; }{}\n"
    assert volume_mm3(by_gmsh(BOXES + fragments + BOX_NAMES)) == pytest.approx(16.0 + 4.8, rel=1e-12)
    by_gmsh(BOXES.replace("1.1, 1, 1.5", "1.1, 1.2, 1.5") + BOX_NAMES.replace("2.9, 5, 5, 3.1", "3.1, 5, 5, 3.3"))
    assert "that do not touch" in refused()


def test_a_body_in_two_pieces(by_gmsh, tube, refused) -> None:
    other = tube["shape"] + "Box(20) = {9, 0, 0, 1, 1, 1};"
    by_gmsh(other + tube["names"] + 'Physical Volume("wall") = {3, 20};')
    assert re.search(r"in 2 parts of \d+, \d+ cells that do not touch", refused())


@pytest.mark.parametrize(
    ("second", "said"),
    [
        ("{2, 2, 0, 1, 2}", r"that touch and are not joined \(\d+ pairs of nodes in one place"),
        ("{2.33, 2, 0, 0.41, 2}", r"that touch and are not joined \(\d+ facets on others whose nodes are elsewhere"),
        ("{3, 2, 0, 1, 2}", r"that touch and are not joined \(1 pairs of nodes in one place near \(3, 2\) mm"),
        ("{2, 2.5, 0, 1, 2}", r"that do not touch \(.*\): solve one part at a time .* physical surfaces"),
        ("{2.4, 1.5, 0, 1, 2}", "that touch and are not joined|that do not touch .or go through each other"),
    ],
    ids=["same nodes", "other nodes", "corner", "apart", "overlapping"],
)
def test_meridians_of_two_parts(by_gmsh, refused, second: str, said: str) -> None:
    by_gmsh(
        'SetFactory("OpenCASCADE"); Rectangle(1) = {2, 0, 0, 1, 2}; Rectangle(2) = ' + second + ";"
        "Mesh.ElementOrder = 2; Mesh.CharacteristicLengthMax = 0.5;\n"
        'Physical Curve("cavity") = {4}; Physical Curve("clamped") = {1}; Physical Surface("wall") = {1, 2};',
        dimension=2,
    )
    assert re.search(r"in 2 parts of \d+, \d+ cells " + said, refused())


def test_nodes_doubled_along_a_part_of_a_surface(written, blocks, refused) -> None:
    points, cells = blocks[0]((2, 1, 3))
    groups = blocks[1](points, cells)
    # a slit between the upper two layers, under the half x < 2
    slit = [k for k, p in enumerate(points) if p[2] == 4.0 and p[0] == 0.0]
    above = [c for c, cell in enumerate(cells) if points[cell][:, 2].min() == 4.0]
    cells = cells.copy()
    for k, node in enumerate(slit):
        cells[above] = np.where(cells[above] == node, len(points) + k, cells[above])
    written(np.vstack([points, points[slit]]), {**groups, "wall": (3, 5, cells)})
    said = refused()
    assert (
        "two parts of the surface lie on each other and are not joined (6 pairs of nodes" in said
    )  # 2 corners, 4 midway
    assert "near (0, 0, 4) mm" in said


@pytest.mark.parametrize(
    ("size", "kept", "said"),
    [
        # of two layers the lower one is whole; of the upper one two cubes are left, which meet in an edge
        ((2, 2, 2), lambda i, j, k: k == 0 or i == j, "meets itself only in an edge or a point"),
        ((2, 2, 1), lambda i, j, k: i == j, "in 2 parts of 1, 1 cells that meet only in an edge or a point"),
        ((2, 2, 2), lambda i, j, k: i == j == k, "in 2 parts of 1, 1 cells that meet only in an edge or a point"),
        # two towers on a plate, whose roofs meet in a corner
        (
            (4, 4, 4),
            lambda i, j, k: k == 0 or (i == 0 and j == 0) or (i == 3 and j == 3) or (k == 3 and i == 0 and j < 2)
            or (k == 3 and i == 1 and j == 1) or (k == 2 and i in (2, 3) and j == 3) or (k == 2 and i == j == 2),
            "meets itself only in an edge or a point (1 nodes",
        ),
    ],
    ids=["edge in one body", "edge", "point", "point in one body"],
)  # fmt: skip
def test_parts_that_meet_in_an_edge_or_a_point(written, blocks, refused, size, kept, said: str) -> None:
    points, cells = blocks[0](size)
    places = (points[cells].min(axis=1) / 2.0).astype(int)
    cells = cells[[kept(*p) for p in places.tolist()]]
    written(points, blocks[1](points, cells))
    assert said in refused()


def test_cells_twice_over_and_overlapping(written, blocks, refused) -> None:
    points, cells = blocks[0]((2, 1, 2))
    groups = blocks[1](points, cells)
    written(points, {**groups, "wall": (3, 5, np.vstack([cells, cells[:1]]))})
    assert "1 of 4 cells are there more than once" in refused()
    # a third cell on a facet that has two
    roof = np.array([[1.0, 1.0, 5.0]] * 4) + [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    over = np.vstack([cells, [[*cells[0, 4:], *range(len(points), len(points) + 4)]]])
    written(np.vstack([points, roof]), {**groups, "wall": (3, 5, over)})
    assert "cells overlap near" in refused()
    # a cell pulled through the facet it stands on: turned inside out
    inner = points.copy()
    inner[(points[:, 2] == 4.0)] -= [0.0, 0.0, 3.5]
    written(inner, groups)
    assert "cells overlap near" in refused()


def test_a_corner_within_the_edge_of_another_cell(written, refused) -> None:
    # three by two quadrilaterals of nine nodes; in a damaged file one had the middle of a neighbour's edge as a corner
    points = np.array([[5.0 + 0.3 * i, 0.5 * j, 0.0] for j in range(5) for i in range(7)])
    grid = np.arange(35).reshape(5, 7)

    def nodes(i: int, j: int) -> list[int]:
        g = grid[j : j + 3, i : i + 3]
        return [g[0, 0], g[0, 2], g[2, 2], g[2, 0], g[0, 1], g[1, 2], g[2, 1], g[1, 0], g[1, 1]]

    cells = np.array([nodes(i, j) for j in (0, 2) for i in (0, 2, 4)])
    cavity = np.array([[grid[0, 0], grid[2, 0], grid[1, 0]], [grid[2, 0], grid[4, 0], grid[3, 0]]])
    clamped = np.array([[grid[0, i], grid[0, i + 2], grid[0, i + 1]] for i in (0, 2, 4)])
    groups = {"cavity": (1, 8, cavity), "clamped": (1, 8, clamped)}
    assert volume_mm3(written(points, {**groups, "elastomer": (2, 10, cells)})) > 0.0
    damaged = cells.copy()
    damaged[4, 0] = grid[2, 1]
    written(points, {**groups, "elastomer": (2, 10, damaged)})
    assert "a node is a corner of one and within an edge of another" in refused()
