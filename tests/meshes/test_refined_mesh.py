"""Uniform refinement: the shape, the volume and the named surfaces stay what they were, also where cells are curved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshes.bodies import sphere_meridian
from meshes.quality import jacobians, mesh_quality, region_volumes_mm3
from meshes.revolve import revolve
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.surface import surface_weights
from meshes.sweep import revolve_hexahedra
from meshes.users.neighbours import Neighbours, ridges
from meshes.users.orientation import oriented
from meshes.users.refine import refined


def curved(kind: str) -> SolidMesh:
    """Half a hollow sphere 5/7 mm, or a quarter of it in hexahedra, in few curved cells, not all the same way round."""
    if kind == "hexahedron":
        mesh = revolve_hexahedra(sphere_meridian(5.0, 7.0, 3, 2, "quadrilaterals"), 2, np.pi / 2)
    else:
        mesh = sphere_meridian(5.0, 7.0, 3, 1, "quadrilaterals" if kind == "quadrilateral" else "triangles")
    mesh = revolve(mesh, 8) if kind == "tetrahedron" else mesh
    cells = oriented(Path("made here"), mesh.points, mesh.cells, np.arange(len(mesh.cells)))
    return replace(mesh, cells=cells, regions=1 + np.arange(len(cells)) % 3)


KINDS = ["triangle", "quadrilateral", "tetrahedron", "hexahedron"]


@pytest.mark.parametrize("kind", KINDS)
def test_children_fill_their_parents_and_carry_their_names(kind: str) -> None:
    coarse = curved(kind)
    assert coarse.cell.name == kind
    fine = refined(coarse)
    assert len(fine.cells) == 2**fine.dimension * len(coarse.cells)
    assert len(fine.facets) == 2 ** (fine.dimension - 1) * len(coarse.facets)
    assert (jacobians(fine.points, fine.cells) > 0.0).all()
    # each region and each named surface keeps its size: children lie in their own parents
    for name, volume in region_volumes_mm3(coarse).items():
        assert region_volumes_mm3(fine)[name] == pytest.approx(volume, rel=1e-12), name
    for name in ("cavity", "outer", "bottom"):
        # areas are roots of polynomials, which four Gauss points take to 1e-6
        assert surface_weights(fine, name).sum() == pytest.approx(surface_weights(coarse, name).sum(), rel=1e-5)
    assert fine.points[fine.tip_centre_node] == pytest.approx(coarse.points[coarse.tip_centre_node], abs=1e-14)
    assert mesh_quality(fine).min_jacobian_ratio > 0.9 * mesh_quality(coarse).min_jacobian_ratio


@pytest.mark.parametrize("kind", KINDS)
def test_neighbours_agree_on_the_nodes_between_them(kind: str) -> None:
    coarse = curved(kind)
    fine = refined(refined(coarse))
    found = Neighbours(fine.cells, fine.cell)
    assert not len(found.crowded)
    assert not found.alike(found.pairs).any()
    # as many facets on the surface as the coarse mesh has parts of: no gap opened between neighbours
    assert len(found.boundary) == 4 ** (fine.dimension - 1) * len(Neighbours(coarse.cells, coarse.cell).boundary)
    assert len(ridges(found.corners(found.boundary))[2]) == 0
    assert len(np.unique(fine.points.round(9), axis=0)) == len(fine.points)
    assert REGIONS["elastomer"] in fine.regions
    assert FACETS["cavity"] in fine.facet_tags
