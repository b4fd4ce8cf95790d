"""A form is found compiled by whoever builds it anew, whatever was compiled before it."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from solvers import compat

# Corners, then midpoints of the edges, then the middle of the square, as basix numbers them.
SQUARE = np.array([[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0], [0, 0.5], [1, 0.5], [0.5, 1], [0.5, 0.5]], dtype=float)


@pytest.fixture
def no_kept_forms(tmp_path, monkeypatch):
    """A cache with nothing in it, so that a form is compiled and not found."""
    monkeypatch.setitem(compat.JIT, "cache_dir", tmp_path)


def test_a_compilation_changes_no_later_form(no_kept_forms: None) -> None:
    mesh = compat.make_mesh(MPI.COMM_SELF, np.arange(9)[None], SQUARE)
    space = compat.function_space(mesh, compat.element("Lagrange", mesh.ufl_cell(), 2))
    dx = ufl.dx(domain=mesh)
    before = ufl.TestFunction(space)
    told = (before * dx).signature()
    compat.compile_form(fem.Constant(mesh, 1.0) * dx)
    after = ufl.TestFunction(space)
    assert (after * dx).signature() == told
    assert before == after
