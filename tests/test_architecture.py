"""The recipes of docs/architecture.md are followed: their code is run and its numbers are checked."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from analytical.exact.homogeneous import nominal_stress_mpa
from analytical.laws.isotropic import hessian_of_i1_law
from analytical.laws.numerical import EnergyLaw
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.bodies import lattice_meridian
from meshes.quality import mesh_quality, region_volumes_mm3
from meshes.solid import FACETS
from solvers.energy.laws import CompiledLaw, compile_law
from solvers.state import State
from studies.engine import Bar, Page, Study, run
from studies.report import pages
from studies.report.tables import Column, pivot
from studies.results.rows import read_rows, row

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def recipe(name: str, **known: Any) -> dict[str, Any]:
    """What the code of a recipe defines."""
    code = re.search(rf"```python\n# {name}: .*?\n(.*?)```", TEXT, re.S)
    assert code is not None, name
    scope: dict[str, Any] = {"np": np, "math": math, "dataclass": dataclass, "Any": Any, **known}
    exec(compile(code[1], f"recipe {name}", "exec", dont_inherit=True), scope)
    return scope


def test_a_law_is_added(strip, sides, make_problem) -> None:
    known = {"ufl": ufl, "compile_law": compile_law, "CompiledLaw": CompiledLaw}
    law = recipe("law", hessian_of_i1_law=hessian_of_i1_law, **known)["Gent"](0.05, 30.0)

    def energy(l1: Any, l2: Any, l3: Any) -> Any:
        return -0.5 * 0.05 * 30.0 * np.log(1.0 - (l1 * l1 + l2 * l2 + l3 * l3 - 3.0) / 30.0)

    exact = EnergyLaw(energy)
    assert exact.initial_shear_modulus_mpa == pytest.approx(law.initial_shear_modulus_mpa, rel=1e-9)
    somewhere = [np.array([value]) for value in (1.8, 0.9, 1.0 / 1.62)]
    assert law.log_hessian_mpa(*somewhere) == pytest.approx(exact.log_hessian_mpa(*somewhere), rel=1e-6, abs=1e-9)
    mesh = strip(1.0, 2.0, 3.0, 2, 2, quadrilaterals=True)
    problem = make_problem(mesh, law, cavity=sides.cavity)
    stretch = 1.8
    across = stretch**-0.5 - 1.0
    moved = mesh.points * np.array([across, stretch - 1.0])
    problem.set_state(State(moved, problem.zero_state().pressure_mpa, problem.body_values.copy(), 0.0))
    volume = region_volumes_mm3(mesh)["elastomer"]
    found = problem.energy() / volume
    assert found == pytest.approx(float(exact.energy(stretch, stretch**-0.5, stretch**-0.5)), rel=1e-10)
    # the work of the nodal forces in stretching is the nominal stress times the volume
    force, _ = problem.internal_force()
    work = sum(
        force[problem.u_dofs[:, i]] @ (mesh.points[problem.domain.input_node, i] * rate)
        for i, rate in ((0, -0.5 * stretch**-1.5), (1, 1.0))
    )
    assert work / volume == pytest.approx(float(nominal_stress_mpa(exact, "uniaxial", stretch)), rel=1e-9)


def test_a_geometry_is_added(make_problem) -> None:
    mesh = recipe("geometry", lattice_meridian=lattice_meridian)["cone_meridian"](4.0, 6.0, 1.0, 10.0, 8, 2)
    assert mesh_quality(mesh).min_jacobian_ratio > 0.9
    # a wall of constant radial thickness: pi L w (2 r + w) with the mean radius, and the cone inside it
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(math.pi * 10.0 * (2.0 * 5.0 + 1.0), rel=1e-12)
    problem = make_problem(mesh, DRAGON_SKIN_10, cavity=FACETS["cavity"], clamped=FACETS["bottom"])
    assert problem.cavity_volume() == pytest.approx(math.pi * 10.0 / 3.0 * (16.0 + 24.0 + 36.0), rel=1e-12)


def test_a_study_is_added(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = {"row": row, "pivot": pivot, "Column": Column, "Page": Page, "Bar": Bar, "Study": Study}
    laws = {"DRAGON_SKIN_10": DRAGON_SKIN_10, "dragon_skin_30": dragon_skin_30}
    study = recipe("study", nominal_stress_mpa=nominal_stress_mpa, **known, **laws)["STUDY"]
    (tmp_path / "silicones.md.j2").write_text(
        '{% extends "study.md.j2" %}{% from "macros.md.j2" import table %}'
        "{% block body %}{{ table(stresses) }}{% endblock %}",
        encoding="utf-8",
    )
    monkeypatch.setattr(pages, "TEMPLATES", (*pages.TEMPLATES, tmp_path))
    assert run(study, tmp_path / "out", MPI.COMM_WORLD, {}) == 0
    assert [round(r.value) for r in read_rows(tmp_path / "out" / "rows.csv")] == [171, 737]  # 2 (l - l^-2) W1 at l = 2
    assert "| two silicones | 2 | met |" in (tmp_path / "out" / "report.md").read_text(encoding="utf-8")


FILES = sorted(set(re.findall(r"`((?:solvers|meshes|analytical|studies|tests)/[\w/.]+)", TEXT)))


@pytest.mark.parametrize("path", FILES)
def test_files_named_in_the_text_exist(path: str) -> None:
    assert (ROOT / path.rstrip(".")).exists() or "NAME" in path, path
