"""Users' meshes: read back as they were, in either orientation; everything unfit refused with what to do about it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meshes.bodies import tube_meridian
from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.errors import MeshError
from meshes.quality import jacobians, mesh_quality, region_volumes_mm3
from meshes.solid import FACETS, SolidMesh
from meshes.surface import surface_weights

OCTANT = Path(__file__).resolve().parents[2] / "scenes" / "exact" / "octant.msh"
NAMES = {FACETS["cavity"]: "cavity", FACETS["outer"]: "outer", FACETS["bottom"]: "symmetry_z", FACETS["top"]: "top"}


@pytest.fixture
def written(tmp_path):
    """Write a meridian as a gmsh file of version 2.2 and give its path; parts may be replaced."""

    def write(mesh: SolidMesh, cells=None, points=None, names=None, order: int = 2) -> Path:
        cells = mesh.cells if cells is None else cells
        points = mesh.points if points is None else points
        names = NAMES if names is None else names
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names) + 1)]
        lines += [f'1 {number} "{name}"' for number, name in names.items()] + ['2 99 "elastomer"', "$EndPhysicalNames"]
        lines += ["$Nodes", str(len(points))]
        lines += [f"{k + 1} {x!r} {y!r} 0" for k, (x, y) in enumerate(points.tolist())]
        lines += ["$EndNodes", "$Elements", str(len(mesh.facets) + len(cells))]
        number = 0
        for facet, tag in zip(mesh.facets + 1, mesh.facet_tags, strict=True):
            number += 1
            lines.append(f"{number} 1 2 {tag} {tag} {facet[0]} {facet[1]}")
        for cell in cells[:, [0, 1, 2, 5, 3, 4]] + 1:  # gmsh's order of mid-edge nodes
            number += 1
            kind, nodes = (9, cell) if order == 2 else (2, cell[:3])
            lines.append(f"{number} {kind} 2 99 99 {' '.join(map(str, nodes))}")
        path = tmp_path / "mesh.msh"
        path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="ascii")
        return path

    return write


@pytest.fixture(scope="module")
def meridian() -> SolidMesh:
    return tube_meridian(4.0, 6.0, 3.0, 2, 2)


def test_shipped_octant() -> None:
    mesh = read_user_mesh(OCTANT)
    # curved tetrahedra of 1.7 mm on radii of 5 and 7 mm
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(np.pi / 6.0 * (7.0**3 - 5.0**3), rel=1e-3)
    assert surface_weights(mesh, "cavity").sum() == pytest.approx(np.pi / 2.0 * 25.0, rel=1e-3)
    assert np.abs(mesh.points[mesh.facets[mesh.facet_tags == FACETS["symmetry_x"]], 0]).max() < 1e-12
    quality = mesh_quality(mesh)
    assert quality.boundary_only_cells == 0
    assert quality.min_jacobian_ratio > 0.3


def test_meridian_reads_back_in_either_orientation_and_unit(meridian, written) -> None:
    clockwise = meridian.cells[:, [0, 2, 1, 3, 5, 4]]
    for cells, points, scale in ((meridian.cells, meridian.points, 1.0), (clockwise, 1e-3 * meridian.points, 1e3)):
        mesh = read_user_mesh(written(meridian, cells, points), scale)
        assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(np.pi * 20.0 * 3.0, rel=1e-12)
        assert (jacobians(mesh.points, mesh.cells) > 0.0).all()
        # nodes keep their order, and so do the named edges
        assert mesh.points == pytest.approx(meridian.points, abs=1e-12)
        cavity = FACETS["cavity"]
        assert np.array_equal(
            np.sort(mesh.facets[mesh.facet_tags == cavity], axis=0),
            np.sort(meridian.facets[meridian.facet_tags == cavity], axis=0),
        )


def test_edges_on_the_axis_need_no_name(written) -> None:
    mesh = tube_meridian(1.0, 3.0, 3.0, 2, 2)
    solid = mesh.points - np.array([1.0, 0.0])  # a rod: its bore has become the axis
    without = {number: name for number, name in NAMES.items() if name != "cavity"} | {FACETS["outer"]: "cavity"}
    kept = SolidMesh(**{**vars(mesh), "facets": mesh.facets[mesh.facet_tags != FACETS["cavity"]],
                        "facet_tags": mesh.facet_tags[mesh.facet_tags != FACETS["cavity"]]})  # fmt: skip
    found = read_user_mesh(written(kept, points=solid, names=without))
    axis = found.facets[found.facet_tags == FACETS["axis"]]
    assert len(axis) == 2
    assert (found.points[axis, 0] == 0.0).all()


def test_metres_are_refused_with_the_scale_that_corrects_them(meridian, written) -> None:
    with pytest.raises(MeshError, match=r"bounding box is 0\.003 mm.*scale = 1000"):
        read_user_mesh(written(meridian, points=1e-3 * meridian.points))


def test_first_order_gets_nodes_midway_where_faces_are_flat(meridian, written) -> None:
    mesh = read_user_mesh(written(meridian, order=1))
    assert sorted(mesh.points.tolist()) == pytest.approx(np.array(sorted(meridian.points.tolist())), abs=1e-12)
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(np.pi * 20.0 * 3.0, rel=1e-12)


def test_turned_cells_are_turned_back_and_flat_ones_named_by_their_number(meridian, written) -> None:
    cells = meridian.cells.copy()
    cells[4] = cells[4, [0, 2, 1, 3, 5, 4]]
    assert (jacobians(meridian.points, read_user_mesh(written(meridian, cells)).cells) > 0.0).all()
    points = meridian.points.copy()
    corners = meridian.cells[4]
    points[corners[0]] = 0.5 * (points[corners[1]] + points[corners[2]])
    points[corners[4]] = 0.5 * (points[corners[0]] + points[corners[2]])
    points[corners[5]] = 0.5 * (points[corners[0]] + points[corners[1]])
    points[corners[3]] = points[corners[0]]
    with pytest.raises(MeshError, match=r"cell \d+ near .* is (flat|folded|flipped)"):
        read_user_mesh(written(meridian, points=points))


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ({FACETS["cavity"]: "cavty"}, "'cavty' is unknown; did you mean cavity"),
        ({FACETS["cavity"]: "clamped"}, "no physical curve is named 'cavity'"),
    ],
)
def test_wrong_names_are_refused(meridian, written, names: dict[int, str], said: str) -> None:
    with pytest.raises(MeshError, match=said):
        read_user_mesh(written(meridian, names={**NAMES, **names}))


def test_files_that_are_no_meshes_are_refused(tmp_path) -> None:
    with pytest.raises(MeshError, match="cannot be read"):
        read_user_mesh(tmp_path / "none.msh")
    (tmp_path / "text.msh").write_text("this is not a mesh", encoding="ascii")
    with pytest.raises(MeshError, match=r"text\.msh"):
        read_user_mesh(tmp_path / "text.msh")
