"""Fields for ParaView: node order of every kind of cell, stretches and pressures of known states."""

from __future__ import annotations

import numpy as np
import pytest

from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES
from meshes.revolve import revolve
from meshes.sweep import revolve_hexahedra
from solvers.state import State
from solvers.vtu import pressure_at_nodes, principal_stretches, save_mesh, vtk_grid, write_mode, write_vtu


@pytest.fixture(scope="module")
def body(strip):
    def make(cells: str):
        quadrilaterals = cells == "hexahedra"
        flat = strip(5.0, 6.0, 2.0, 1, 1, 0.1, quadrilaterals)
        return revolve_hexahedra(flat, 6) if quadrilaterals else revolve(flat, 6)

    return make


@pytest.mark.parametrize(("dimension", "name"), [(2, "vtkBiQuadraticQuad"), (3, "vtkTriQuadraticHexahedron")])
def test_nodes_are_in_vtks_order(dimension: int, name: str) -> None:
    import vtk

    from solvers.vtu import _VTK

    cell = getattr(vtk, name)()
    count = cell.GetNumberOfPoints()
    flat = cell.GetParametricCoords()
    at = np.array([flat[k] for k in range(3 * count)]).reshape(count, 3)[:, :dimension]
    kind, order = _VTK["quadrilateral" if dimension == 2 else "hexahedron"]
    nodes = QUADRILATERAL_NODES if dimension == 2 else HEXAHEDRON_NODES
    assert kind == cell.GetCellType()
    assert np.array_equal(0.5 * nodes[order], at)


@pytest.mark.parametrize("cells", ["tetrahedra", "hexahedra"])
def test_stretches_and_pressures_of_known_states(body, cells: str) -> None:
    mesh = body(cells)
    f = np.diag([0.8, 1.25, 1.6])
    p = 0.1 + 0.02 * mesh.points[:, 2]
    p_state = p[mesh.cells[:, : mesh.cell.corners]] if cells == "hexahedra" else p
    state = State(mesh.points @ (f - np.eye(3)), p_state, np.zeros((0, 0)), 0.0)
    # an affine state: round-off
    assert principal_stretches(mesh, state) == pytest.approx(np.tile([0.8, 1.25, 1.6], (len(p), 1)), rel=1e-12)
    assert pressure_at_nodes(mesh, state)[mesh.corners] == pytest.approx(p[mesh.corners], rel=1e-12)
    grid = vtk_grid(mesh, state)
    assert grid.point_data["stretch_max"].max() == pytest.approx(1.6, rel=1e-12)
    # VTK's own volume, of cells split into straight pieces, tells order and orientation: 60 degrees per parabola
    exact = np.pi * (36.0 - 25.0) * 2.0
    assert abs(grid.compute_cell_sizes()["Volume"]).sum() == pytest.approx(exact, rel=0.2)


def test_fields_are_written_whole_or_not_at_all(body, tmp_path, monkeypatch) -> None:
    import pyvista

    mesh, file = body("hexahedra"), tmp_path / "fields" / "p05.000.vtu"
    blank = State(0.0 * mesh.points, np.zeros((len(mesh.cells), 8)), np.zeros((0, 0)), 0.0)
    write_vtu(file, mesh, blank)
    whole, save = file.read_bytes(), pyvista.UnstructuredGrid.save

    def cut_short(grid, path, *options):
        save(grid, path, *options)
        path.write_bytes(path.read_bytes()[:1000])

    def killed(grid, path, *options):
        cut_short(grid, path, *options)
        raise KeyboardInterrupt

    for fault, error in ((cut_short, OSError), (killed, KeyboardInterrupt)):
        monkeypatch.setattr(pyvista.UnstructuredGrid, "save", fault)
        for write in (lambda: write_vtu(file, mesh, blank), lambda: save_mesh(file, mesh)):
            with pytest.raises(error):
                write()
            assert file.read_bytes() == whole
        with pytest.raises(error):
            write_mode(tmp_path / "mode", mesh, blank, blank)
        assert not (tmp_path / "mode.vtu").exists()
