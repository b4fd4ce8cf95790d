"""Surfaces of bodies as they are drawn: round where the body is round, and bands with round bounds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meshes.bodies import tube_meridian
from meshes.solid import SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers.state import State
from solvers.vtu import write_vtu
from studies.report.pictures.outside import nice_bounds
from studies.report.pictures.stills import Still

INNER, OUTER = 2.0, 3.0


@pytest.fixture
def tube() -> SolidMesh:
    """A tube of 8 cells round."""
    return revolve_hexahedra(tube_meridian(INNER, OUTER, 1.0, 1, 1, "quadrilaterals"), 8)


def test_a_round_body_is_drawn_round(tube: SolidMesh, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    from studies.report.pictures.bodies import body_of, surface_of

    state = State(np.zeros_like(tube.points), np.zeros(len(tube.points)), np.zeros((0, 0)), 0.0)
    write_vtu(tmp_path / "tube.vtu", tube, state)
    body = body_of(Still("", tmp_path / "tube.vtu"))
    body["stretch_max"] = np.hypot(*body.points[:, :2].T)
    surface = surface_of(body, np.ones(body.n_cells, dtype=bool))
    radius = np.hypot(*surface.points[:, :2].T)
    outside = surface.points[radius > 0.98 * OUTER]
    angles = np.unique(np.round(np.arctan2(outside[:, 1], outside[:, 0]) % (2.0 * np.pi - 1e-6), 5))
    assert len(angles) == 32  # four to a cell; its corners and mid-edge nodes alone are two
    # a parabola through three points of a circle, 45 degrees long, leaves it by 0.05 %
    assert np.abs(np.linalg.norm(outside[:, :2], axis=1) / OUTER - 1.0).max() < 1e-3
    assert surface["stretch_max"] == pytest.approx(radius, rel=1e-3)  # the field goes with its points
    assert not surface.extract_feature_edges(feature_edges=False, manifold_edges=False).n_cells  # closed: nothing open


@pytest.mark.parametrize(
    ("largest", "bounds"), [(89.5, np.arange(0.0, 91.0, 10.0)), (90.0, np.arange(0.0, 91.0, 10.0)), (1.7, None)]
)
def test_bands_end_at_round_numbers(largest: float, bounds: np.ndarray | None) -> None:
    found = nice_bounds(largest)
    if bounds is not None:
        assert found == pytest.approx(bounds)
    assert found[0] == 0.0 and found[-2] < largest <= found[-1] and len(found) <= 10
