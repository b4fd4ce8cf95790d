"""What a report says first: the answer in words, and no more of stability than was counted."""

from __future__ import annotations

from dataclasses import replace

from studies.report.scenes import answer
from tests.studies.report.test_report import make_scene


def test_the_answer_names_value_model_and_closed_form() -> None:
    said = answer(make_scene())
    assert said.startswith("At 20 kPa the elongation at the tip is") and "(full 3D)" in said
    assert "the closed form is" in said


def test_sideways_modes_of_an_axisymmetric_answer_are_told() -> None:
    scene = make_scene()
    runs = tuple(run for run in scene.runs if run.model == "axisymmetric")
    rows = tuple(row for row in scene.rows if row.model != "full3d")
    paths = {key: path for key, path in scene.paths.items() if key.startswith("axisymmetric")}
    flat = replace(scene, runs=runs, rows=rows, paths=paths)
    bare = {key: [replace(s, unstable_modes=0, unstable_by_m="") for s in path] for key, path in paths.items()}
    assert "Stable" in answer(replace(flat, paths=bare)) and "others were not counted" in answer(
        replace(flat, paths=bare)
    )
    bent = {key: [replace(s, unstable_by_m="0;1;0;0;0;0;0") for s in path] for key, path in bare.items()}
    assert "Unstable at" in answer(replace(flat, paths=bent)) and "Stable" not in answer(replace(flat, paths=bent))
    whole = {key: [replace(s, unstable_by_m="0;0;0;0;0;0;0") for s in path] for key, path in bare.items()}
    assert answer(replace(flat, paths=whole)).endswith("Stable at every pressure that was reached")
