"""Forms are found without being written in UFL, those that were written for the same problem and no others."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest
import ufl

import solvers.problem
from analytical.laws.isotropic import NeoHooke, Ogden
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.revolve import revolve
from solvers import compat
from solvers.compat import known_forms, stack
from solvers.compat.known_forms import KnownForms
from solvers.energy.laws import CompiledLaw, compile_law
from solvers.linear.factor import Factor
from solvers.stability.harmonics import Harmonics

pytestmark = pytest.mark.skipif(not stack.TAKES_PARTS, reason="this version of dolfinx makes no form of its parts")


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch) -> Any:
    """The files of known forms in a folder of the test's own; compiled forms stay where they are."""
    monkeypatch.setattr(known_forms, "_folder", lambda: tmp_path)
    return tmp_path


@pytest.fixture
def built(monkeypatch) -> list[Any]:
    """What is written in UFL from now on."""
    written: list[Any] = []
    write = known_forms.compile_form

    def told(form: Any) -> Any:
        written.append(form)
        return write(form)

    monkeypatch.setattr(known_forms, "compile_form", told)
    return written


def entries(problem: Any) -> dict[str, np.ndarray]:
    """What a problem's forms come to at a state that is nobody's: residual, load, tangent, energy, volumes."""
    rng = np.random.default_rng(5)
    problem.state.x.array[:] = 0.01 * rng.standard_normal(len(problem.state.x.array))
    problem.pressure.value = 0.01
    factor = Factor(problem)
    problem.assemble_tangent(factor.matrix)
    found = {
        "tangent": factor.matrix.getValuesCSR()[2],
        "internal force": problem.internal_force()[0],
        "load": problem.load.gradient(),
        "traction": problem.load.traction(),
        "numbers": np.array([problem.energy(), problem.cavity_volume(), problem.volume_unit_mm3]),
    }
    factor.close()
    if problem.bonded is not None:
        found["slip"] = np.array([problem.bonded.rms_slip_mm()])
    return found


def assert_same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    for name in one:
        assert np.array_equal(one[name], other[name]), name


def test_a_second_problem_writes_nothing_and_is_the_same(make_problem, strip, built) -> None:
    body = revolve(strip(4.0, 5.0, 2.0, 1, 1), 8)
    surfaces = {"cavity": 1, "clamped": 2}
    first = make_problem(body, DRAGON_SKIN_10, **surfaces)
    written = len(built)
    assert written >= 7  # internal force, energy, tangent, volume and its gradient, traction, cells
    second = make_problem(body, DRAGON_SKIN_10, **surfaces)
    assert len(built) == written
    assert_same(entries(first), entries(second))


def test_the_same_with_rings_and_in_harmonics(bellows_problem, make_problem, built) -> None:
    case = bellows_problem(2)
    surfaces = {f.name: getattr(case.problem.surfaces, f.name) for f in dataclasses.fields(case.problem.surfaces)}

    def anew() -> Any:
        return make_problem(case.mesh, DRAGON_SKIN_10, bodies=case.problem.bodies, **surfaces)

    first = anew()
    tangents = [tangent_of(Harmonics(first))]
    written = len(built)
    second = anew()
    tangents.append(tangent_of(Harmonics(second)))
    assert len(built) == written > 14
    assert_same(entries(first), entries(second))
    assert np.array_equal(tangents[0], tangents[1])


def tangent_of(harmonics: Harmonics) -> np.ndarray:
    harmonics.select(1)
    matrix = harmonics.new_matrix()
    harmonics.assemble_tangent(matrix)
    return np.asarray(matrix.getValuesCSR()[2])


@pytest.mark.parametrize(
    "change",
    [
        {"law": NeoHooke(0.05)},
        {"inverse_kappa": 0.1},
        {"cavity": None, "dead": 1},
        {"clamped": 3},
        {"quadrature_degree": 6},
        {"frame": np.eye(3)},
    ],
    ids=lambda change: "-".join(map(str, change)),
)
def test_another_problem_has_forms_of_its_own(make_problem, strip, change, own_cache) -> None:
    body = revolve(strip(4.0, 5.0, 2.0, 1, 1), 8)
    usual = {"law": DRAGON_SKIN_10, "cavity": 1, "clamped": 2}
    make_problem(body, **usual)
    other = entries(make_problem(body, **{**usual, **change}))
    for file in own_cache.glob("forms_*.json"):
        file.unlink()
    assert_same(other, entries(make_problem(body, **{**usual, **change})))


@dataclasses.dataclass(frozen=True)
class Mine(NeoHooke):
    """A law of a user's own."""


def test_a_law_that_a_user_writes_is_written_each_time(make_problem, strip, built) -> None:
    body = strip(4.0, 5.0, 2.0, 1, 1)
    first = make_problem(body, Mine(0.05), cavity=1, clamped=2)
    written = len(built)

    @compile_law.register
    def softer(law: Mine, constant: Any) -> CompiledLaw:
        return compile_law(NeoHooke(0.5 * law.mu_mpa), constant)

    second = make_problem(body, Mine(0.05), cavity=1, clamped=2)
    assert len(built) == 2 * written
    one, other = entries(first), entries(second)
    assert other["numbers"][0] == pytest.approx(0.5 * one["numbers"][0])


def test_new_source_writes_forms_anew_and_keeps_none_of_a_source_edited_meanwhile(
    make_problem, strip, built, monkeypatch, own_cache
) -> None:
    body = strip(4.0, 5.0, 2.0, 1, 1)
    make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    written, files = len(built), set(own_cache.iterdir())
    # as if the files were others when this process began
    monkeypatch.setattr(known_forms, "_SOURCE", "of before")
    for k in (2, 3):
        make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
        assert len(built) == k * written
    assert set(own_cache.iterdir()) == files


PARTS = ("spaces", "functions", "constants")


@pytest.mark.parametrize("spoil", ["damaged", "other parts", "too few parts", "no module"])
def test_a_file_that_does_not_fit_is_not_taken(make_problem, strip, built, own_cache, spoil: str) -> None:
    body = strip(4.0, 5.0, 2.0, 1, 1)
    before = entries(make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2))
    written = len(built)
    (file,) = own_cache.glob("forms_*.json")
    records = json.loads(file.read_text())
    of_none = 0  # what the surface encloses is made of the mesh alone: such a form fits
    for record in records.values():
        of_none += spoil.endswith("parts") and not any(record[kind] for kind in PARTS)
        if spoil == "no module":
            record["module"] = "libffcx_forms_gone"
        elif spoil == "other parts":
            record.update({kind: [[i, f"another {like}"] for i, like in record[kind]] for kind in PARTS})
        elif spoil == "too few parts":
            record.update({kind: [[i + 100, like] for i, like in record[kind]] for kind in PARTS})
    file.write_text("{" if spoil == "damaged" else json.dumps(records))
    after = entries(make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2))
    assert len(built) == 2 * written - of_none
    assert_same(before, after)


def test_a_part_that_was_not_taken_is_an_error(make_problem, strip, own_cache) -> None:
    problem = make_problem(strip(4.0, 5.0, 2.0, 1, 1), DRAGON_SKIN_10, cavity=1, clamped=2)
    mesh = problem.domain.mesh
    stray = compat.function_space(mesh, ("DG", 0))
    known = KnownForms(mesh, {}, "stray")
    with pytest.raises(AssertionError, match="was not taken"):
        known.compile("stray", lambda: ufl.TestFunction(stray) * ufl.dx(domain=mesh))


def test_what_cannot_be_kept_is_written_again(make_problem, strip, built, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(known_forms, "_folder", lambda: tmp_path / "no such folder")
    body = strip(4.0, 5.0, 2.0, 1, 1)
    make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    written = len(built)
    make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    assert len(built) == 2 * written


def test_what_is_found_needs_nothing_that_writes(monkeypatch, make_problem, strip) -> None:
    body = strip(4.0, 5.0, 2.0, 1, 1)
    make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    monkeypatch.setattr(solvers.problem, "build_forms", None)
    make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    with pytest.raises(TypeError):
        make_problem(body, Ogden(0.05, 3.0, "2mu/alpha^2"), cavity=1, clamped=2)
