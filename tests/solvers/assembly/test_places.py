"""Tangents from places known beforehand are those of dolfinx' assembler, for every kind of problem."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.surface import boundary_edges
from solvers import compat
from solvers.assembly import places
from solvers.assembly.tangent import new_matrix
from solvers.contact.contact import Contact
from solvers.contact.obstacles import Bore
from solvers.contact.pairs import Against, ContactSettings, Line
from solvers.linear.factor import Factor

SCRIPT = Path(__file__).with_name("places_script.py")


@pytest.mark.parametrize("ranks", [1, 2])
def test_tangents_are_those_of_dolfinx(python, ranks: int) -> None:
    found = python.answer(ranks, SCRIPT)
    assert len(found) == (18 if ranks == 1 else 12)  # harmonics are on one rank
    for kind, (difference, elsewhere) in found.items():
        # the same sums in the same order on one rank; on two, cells between them come last: round-off
        assert difference <= (0.0 if ranks == 1 else 1e-14), kind
        # displacements 1e-8 larger are seen: in a tube on a plate of 300 MPa/mm at 8e-13 of the largest entry
        assert elsewhere > 1e-13, kind


def test_places_follow_a_matrix_that_contact_has_made_anew(strip, sides, make_problem) -> None:
    mesh = strip(5.0, 6.0, 2.0, 2, 2, quadrilaterals=True)
    problem = make_problem(mesh, DRAGON_SKIN_10, cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 1)))
    at = np.flatnonzero(np.isclose(mesh.points[:, 0], 6.0))
    line = Line(at[np.argsort(mesh.points[at, 1])], -1.0, np.ones(2, dtype=bool))
    settings = ContactSettings(stiffness_mpa_per_mm=20.0, smoothing_mm=1e-3, depth_mm=0.4, reach_mm=0.1, limit_mm=0.01)
    pair = Against("housing", 0, Bore(6.05), None, np.empty(0))
    problem.contact = Contact(problem.unknowns, mesh.points, [line], [pair], settings, boundary_edges(mesh))
    factor = Factor(problem)
    before = factor.matrix
    factor.refresh()
    assert factor.matrix is not before
    with_contact = factor.matrix
    plain = new_matrix(problem.space, 0, True)
    compat.add_by_dolfinx(plain, problem._tangent, problem.unknowns.supports.bcs)
    plain.assemble()
    contact = problem.contact._stiffness()
    assert contact.nnz > 0
    indptr, columns, values = with_contact.getValuesCSR()
    of_plain = plain.getValuesCSR()
    size = (problem.owned, problem.owned)
    held = csr_matrix(np.diag(problem.constrained_owned.astype(float)))
    exact = csr_matrix(of_plain[::-1], shape=size) + contact + held
    gap = csr_matrix((values, columns, indptr), shape=size) - exact
    # round-off
    assert np.abs(gap.data).max(initial=0.0) < 1e-14 * np.abs(values).max()


def test_a_matrix_without_the_places_is_refused(strip, sides, make_problem) -> None:
    problem = make_problem(strip(5.0, 6.0, 2.0, 2, 2), DRAGON_SKIN_10, cavity=sides.cavity)
    each = np.arange(problem.owned + 1, dtype=PETSc.IntType)
    diagonal = PETSc.Mat().createAIJ(2 * [problem.owned], csr=(each, each[:-1], np.zeros(problem.owned)))
    with pytest.raises(AssertionError, match="no place"):
        places.Places(diagonal, problem.space)


def test_processes_that_compile_at_once_all_find_it_whole(python, monkeypatch, tmp_path) -> None:
    code = "from solvers.compat.native import library; from solvers.assembly.places import SOURCE; library(SOURCE)"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    running = [python.start(1, "-c", code) for _ in range(3)]
    for process in running:
        python.finish(process)
    (only,) = (tmp_path / "fenics").iterdir()  # nothing half made is left
    assert only.name.startswith("places_")
