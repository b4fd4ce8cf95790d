"""Cells cut towards the seats' edges: conforming, nested, the same surfaces, fit to be swept; places read off them."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from meshes.cells import CellKind
from meshes.eccentric import shift_core
from meshes.errors import MeshError
from meshes.gaps import outlines
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians, region_volumes_mm3
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import FACETS, SolidMesh
from meshes.strip.corners import cut_corners, divided, number_nodes, strip_cells
from meshes.strip.places import cells_at, interpolation
from meshes.sweep import revolve_hexahedra

KINDS = pytest.mark.parametrize("kind", ["triangles", "quadrilaterals"])


def cut_mesh(shape: BellowsShape, kind: CellKind, cuts: int = 2, refinement: int = 1) -> SolidMesh:
    return meridian_mesh(
        shape, dataclasses.replace(default_resolution(shape, refinement, kind), edge_cuts=cuts), None, kind
    )


def areas(cells: np.ndarray) -> np.ndarray:
    """Signed areas of cells (m, 4, 2) by their diagonals."""
    one, other = cells[:, 3] - cells[:, 0], cells[:, 2] - cells[:, 1]
    return 0.5 * (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


@pytest.mark.parametrize("vertex", [(0, 0), (0, 2), (3, 0), (3, 2), (1, 2), (2, 0), (1, 1)])
def test_cut_cells_fill_the_strip_whichever_corner_the_vertex_is(vertex: tuple[int, int]) -> None:
    cells = strip_cells(3, 2, [vertex], 3)
    s, t = vertex
    touching = (2 if 0 < s < 3 else 1) * (2 if 0 < t < 2 else 1)
    assert len(cells) == 6 + 2 * 3 * touching
    assert areas(cells).min() > 0.0  # none turned over
    assert areas(cells).sum() == 6.0  # halves and their sums are exact
    at_vertex = (cells == np.array(vertex, dtype=float)).all(axis=2).any(axis=1)
    assert areas(cells[at_vertex]) == pytest.approx(0.125**2)


def test_cells_of_neighbours_share_whole_edges() -> None:
    _, nodes = number_nodes(strip_cells(4, 1, [(2, 1)], 2, 2))
    edges = np.vstack([nodes[:, line] for line in ([0, 1, 2], [6, 7, 8], [0, 3, 6], [2, 5, 8])])
    ends = np.sort(edges[:, [0, 2]], axis=1)
    _, back, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    assert set(count) == {1, 2}
    for edge in np.flatnonzero(count == 2):
        assert len(set(edges[back.ravel() == edge, 1])) == 1  # and the node in its middle
    # what is on one side only is the strip's boundary: two by sixteen edges at least along it, four across
    points, _ = number_nodes(strip_cells(4, 1, [(2, 1)], 2, 2))
    alone = points[ends[np.isin(back.ravel(), np.flatnonzero(count == 1))]]
    on_side = (alone[:, :, 1] == 0.0).all(axis=1) | (alone[:, :, 1] == 1.0).all(axis=1)
    on_end = (alone[:, :, 0] == 0.0).all(axis=1) | (alone[:, :, 0] == 4.0).all(axis=1)
    assert (on_side | on_end).all()


def test_two_vertices_in_one_cell_are_refused() -> None:
    with pytest.raises(AssertionError, match="two singular vertices"):
        cut_corners(divided(strip_cells(1, 1, [], 0), 1), [(0, 0), (1, 1)])


@KINDS
@pytest.mark.parametrize("refinement", [1, 2])
def test_surfaces_and_volumes_stay_what_they_are(
    one_convolution: BellowsShape, boundary_of, kind: CellKind, refinement: int
) -> None:
    plain, mesh = (cut_mesh(one_convolution, kind, cuts, refinement) for cuts in (0, 2))
    if kind == "triangles":
        named = mesh.facets[np.lexsort(mesh.facets.T[::-1])]
        assert np.array_equal(named, boundary_of(mesh.cells, 2))
    for tag in np.unique(plain.facet_tags):
        for body in (-1, 0, 1):
            lengths = []
            for of in (plain, mesh):
                ends = of.points[of.facets[(of.facet_tags == tag) & (of.facet_bodies == body)]]
                lengths.append(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())
            # edges of arcs are cut into shorter chords
            assert lengths[1] == pytest.approx(lengths[0], rel=1e-12 if body >= 0 else 0.01)
    signed = jacobians(mesh.points, mesh.cells)
    assert (np.abs(np.sign(signed).sum(axis=1)) == signed.shape[1]).all()
    for region, volume in region_volumes_mm3(plain).items():
        # arcs of at most 45 degrees as parabolas are off by 3e-4; cut ones by less
        assert region_volumes_mm3(mesh)[region] == pytest.approx(volume, rel=5e-4)


@KINDS
def test_edges_at_a_seat_halve_with_each_cut_and_with_each_level(one_convolution: BellowsShape, kind: CellKind) -> None:
    def shortest(cuts: int, refinement: int) -> float:
        mesh = cut_mesh(one_convolution, kind, cuts, refinement)
        ends = mesh.points[mesh.facets[mesh.facet_tags == FACETS["bond"]]]
        return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).min())

    usual = shortest(0, 1)
    for cuts, refinement in ((1, 1), (2, 1), (2, 2), (2, 4)):
        assert shortest(cuts, refinement) == pytest.approx(usual / 2**cuts / refinement, rel=1e-12)


def test_levels_are_nested(one_convolution: BellowsShape) -> None:
    coarse, fine = (cut_mesh(one_convolution, "quadrilaterals", 2, refinement) for refinement in (1, 2))
    assert len(fine.cells) == 4 * len(coarse.cells)
    corners = {tuple(p) for p in np.round(fine.points[fine.corners], 9)}
    assert {tuple(p) for p in np.round(coarse.points[coarse.corners], 9)} <= corners
    # all nodes of a fine cell are in the coarse cell that its middle is in
    middle, _ = interpolation(coarse, fine.strip[fine.cells[:, 8]])
    ends = coarse.strip[middle[:, [0, 1, 3, 2]]]
    for nodes, ring in zip(fine.strip[fine.cells], ends, strict=True):
        along = np.roll(ring, -1, axis=0) - ring
        away = nodes[None] - ring[:, None]
        assert (along[:, None, 0] * away[..., 1] - along[:, None, 1] * away[..., 0]).min() > -1e-12


@KINDS
def test_places_within_cells_are_read_off_exactly(one_convolution: BellowsShape, kind: CellKind) -> None:
    mesh, finer = cut_mesh(one_convolution, kind), cut_mesh(one_convolution, kind, 2, 4)

    def linear(at: np.ndarray) -> np.ndarray:
        return np.asarray(2.0 * at[:, 0] - 7.0 * at[:, 1] + 0.5)

    cells, reference = cells_at(mesh, finer.strip)
    assert reference.min() > -1e-9 and reference.max() < 1.0 + 1e-9
    nodes, weights = interpolation(mesh, finer.strip)
    assert np.array_equal(mesh.cells[cells], nodes)
    found = np.einsum("pk,pk->p", weights, linear(mesh.strip)[nodes])
    assert found == pytest.approx(linear(finer.strip), abs=1e-9)  # what Newton's last step leaves
    # positions: arcs of cells on r1 against those on r4, parabolas in 45 degrees
    there = np.einsum("pk,pkd->pd", weights, mesh.points[nodes])
    assert np.abs(there - finer.points).max() < 0.02
    with pytest.raises(MeshError, match="no cell of the meridian's strip"):
        interpolation(mesh, np.array([[-1.0, 0.0]]))


@KINDS
def test_bodies_are_swept_from_them(one_convolution: BellowsShape, kind: CellKind) -> None:
    mesh = cut_mesh(one_convolution, kind)
    body = revolve(mesh, 8) if kind == "triangles" else revolve_hexahedra(mesh, 8)
    seats = body.facet_tags == FACETS["bond"]
    assert set(body.facet_bodies[seats]) == {0, 1} and (body.facet_bodies[~seats] == -1).all()
    moved = shift_core(body, mesh, 0.05 * one_convolution.wall_mm)
    for region, volume in region_volumes_mm3(body).items():
        # eight parabolas round a circle enclose 3e-4 less than it
        assert volume == pytest.approx(region_volumes_mm3(mesh)[region], rel=1e-3)
        assert region_volumes_mm3(moved)[region] == pytest.approx(volume, rel=1e-9)


@KINDS
def test_outlines_run_through_all_nodes_of_their_surface(one_convolution: BellowsShape, kind: CellKind) -> None:
    mesh = cut_mesh(one_convolution, kind)
    cavity, outside = outlines(mesh)
    assert len(outside.nodes) > len(cavity.nodes)  # the seats' edges are on the outside
    for outline in (cavity, outside):
        strip = mesh.strip[outline.nodes]
        steps = np.diff(strip[:, 0])
        assert (steps > 0.0).all() or (steps < 0.0).all()
        assert math.isclose(abs(steps.sum()), mesh.strip[:, 0].max())
