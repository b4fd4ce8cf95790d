"""What several meshes say of a tip: agreement by accident, the value they lead to, the cells round a body."""

from __future__ import annotations

import math

import pytest

from studies.models.tolerance import asked_of
from studies.planning.levels import LIMIT, ranking
from studies.results.bellows_rows import bellows_rows
from studies.results.rows import Row
from studies.results.runs import MERIDIAN_ORDERS, Run, tip_convergence
from studies.results.uncertainty import SAFETY
from tests.studies.paper.paper_demo import make_run, scene_of

FIRST = "heung-t1-ri5"


def test_two_meshes_whose_tips_cross_keep_the_largest_difference_of_the_way() -> None:
    scene = scene_of("core", FIRST)
    # coarse against fine, relative: +0.3 %, then equal by accident, then -0.2 and -0.4 %
    off = {5.0: 0.003, 10.0: 0.0, 15.0: -0.002, 20.0: -0.004}
    runs = [
        make_run(scene, "axisymmetric", level, lambda level, p: 5.0 * p * (1.0 + (off[p] if level == "r1" else 0.0)))
        for level in ("r1", "r2", "r4")
    ]
    assert tip_convergence(runs[:2], 10.0, MERIDIAN_ORDERS).uncertainty(50.0) == pytest.approx(0.004 * 50.0)
    # there by its own difference: midway between orders 1 and 3 (once and a seventh), and once in doubt
    own = (0.5 * (1.0 + 1.0 / 7.0) + 1.0) * 0.004
    assert tip_convergence(runs[:2], 20.0, MERIDIAN_ORDERS).uncertainty(100.0) == pytest.approx(own * 100.0)
    # of three meshes, of which the last two agree everywhere, what an edge of order 1 would leave of that
    assert tip_convergence(runs, 10.0, MERIDIAN_ORDERS).uncertainty(50.0) == pytest.approx(0.004 / 3.0 * 50.0)


def test_three_meshes_lead_to_a_value_of_its_own_and_so_do_bodies_made_from_them() -> None:
    scene, error = scene_of("core", FIRST), {"r1": 1.0, "r2": 0.5, "r4": 0.25}

    def tip(level: str, pressure: float) -> float:
        """An error of order 2 along the meridian; 8 cells round leave 0.05 % more."""
        return 5.0 * pressure * (1.0 + 0.004 * error.get(level, 0.5) ** 2 - (0.0005 if level == "n8r2" else 0.0))

    def tips(*runs: Run) -> dict[str, Row]:
        found = bellows_rows(scene, runs)
        return {
            f"{r.model} {r.level}": r for r in found if (r.quantity, r.pressure_kpa) == ("tip_mm", 20.0) and r.level
        }

    meridians = [make_run(scene, "axisymmetric", level, tip) for level in error]
    rows = tips(*meridians, make_run(scene, "full3d", "n8r2", tip))
    flat, solid = rows[f"axisymmetric {LIMIT}"], rows[f"full3d {LIMIT}"]
    assert flat.value == pytest.approx(100.0, abs=1e-9) and solid.value == pytest.approx(100.0 - 0.05, abs=1e-9)
    assert solid.uncertainty == pytest.approx(flat.uncertainty + SAFETY * 0.05)
    assert flat.uncertainty < rows["axisymmetric r4"].uncertainty and flat.source == f"full3d {LIMIT}"
    assert solid.uncertainty < rows["full3d n8r2"].uncertainty and math.isnan(solid.reference)
    # a study that looks for the last row of a model finds these, and a plan is judged by them
    assert list(rows)[-1] == f"full3d {LIMIT}" and ranking(LIMIT) > ranking("n8r32")
    assert asked_of(scene, list(rows.values()), "full3d", "n8r2") == (solid,)
    # two meshes do not tell it any better than the finer one has it
    assert LIMIT not in " ".join(tips(*meridians[:2]))


def test_the_bend_of_an_eccentric_body_is_not_taken_for_an_error() -> None:
    centred = scene_of("core", FIRST)
    scene = centred.model_copy(update={"geometry": centred.geometry.model_copy(update={"eccentricity": 0.1})})
    meridians = [make_run(scene, "axisymmetric", level, lambda _, p: 5.0 * p) for level in ("r1", "r2", "r4")]
    body = make_run(scene, "full3d", "n8", lambda _, p: 4.75 * p)  # 5 % shorter for bending
    at_20 = {
        case: next(r for r in bellows_rows(of, [*meridians, body]) if (r.model, r.pressure_kpa) == ("full3d", 20.0))
        for case, of in (("bent", scene), ("straight", centred))
    }
    assert at_20["straight"].uncertainty == pytest.approx(SAFETY * 0.05 * 100.0)
    assert at_20["bent"].uncertainty < 0.01 * at_20["bent"].value
