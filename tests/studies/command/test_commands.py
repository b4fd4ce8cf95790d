"""What commands say: help with examples, completion, table and JSON of ``solve``, check, material, mesh."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.command.solve_output import answers
from studies.results.rows import row
from studies.scene.load import load_bellows

COMMANDS = ("new", "draw", "open", "plan", "solve", "report", "batch", "sweep", "study", "check", "material", "mesh")


def invoke(*arguments: object):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def test_all_commands_are_there() -> None:
    assert set(main.commands) == set(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_examples(command: str) -> None:
    done = invoke(command, "--help")
    assert done.exit_code == 0
    assert f"    bellowsx {command}" in done.output


def test_a_new_scene_is_sound_says_what_keys_mean_and_overwrites_nothing(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    assert invoke("new", file).exit_code == 0
    text = file.read_text(encoding="utf-8")
    assert "# R_i, radius of the roots" in text and "free | blocked" in text
    assert load_bellows(file).name == "mine"
    # every key that is commented out may be taken as it stands
    file.write_text(text.replace("\n# ", "\n").replace("points_mm = []", "# "), encoding="utf-8")
    load_bellows(file)
    again = invoke("new", file)
    assert again.exit_code == 2 and "nothing is overwritten" in again.output
    assert invoke("new", tmp_path / "my part.toml").exit_code == 2 and not (tmp_path / "my part.toml").exists()


def test_draw_prints_sizes_and_draws_the_section(root: Path, tmp_path: Path) -> None:
    picture = tmp_path / "section.png"
    done = invoke("draw", root / "scenes" / "heung-t2-ri5.toml", "--picture", picture)
    assert done.exit_code == 0 and picture.stat().st_size > 10_000
    found = {line[:34].strip(): float(line[34:].split()[0]) for line in done.output.splitlines()[:-1]}
    assert found["outer diameter, without rings"] == 25.0 and found["length of the cavity"] == 86.0
    assert found["mass of the silicone"] == pytest.approx(22.08, rel=1e-3)
    # meridians of levels 1, 2, 4, 8 have 20.036, 19.833, 19.782, 19.768 cm³: second order, so 19.764 in the limit
    assert found["volume of the cavity"] == pytest.approx(19.764, rel=5e-4)
    refused = invoke("draw", root / "scenes" / "exact" / "tube.toml")
    assert refused.exit_code == 2 and "bellowsx mesh FILE" in refused.output


def test_open_names_what_there_is_to_look_at(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("", encoding="utf-8")
    done = invoke("open", tmp_path, "--print")
    assert done.exit_code == 0 and "bellowsx report" in done.output and "rows.csv" in done.output
    (tmp_path / "empty").mkdir()
    assert invoke("open", tmp_path / "empty").exit_code == 2


def test_shells_complete_commands() -> None:
    environment = {**os.environ, "_BELLOWSX_COMPLETE": "bash_complete", "COMP_WORDS": "bellowsx so", "COMP_CWORD": "1"}
    code = "from studies.__main__ import run; run()"
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["plain,solve"]


@pytest.fixture(scope="module")
def tube(root: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A scene with exact answers, and where it is solved."""
    return root / "scenes" / "exact" / "tube.toml", tmp_path_factory.mktemp("tube") / "out"


def test_solve_ends_in_a_table_with_a_verdict(tube: tuple[Path, Path]) -> None:
    done = invoke("solve", tube[0], "--out", tube[1])
    assert done.exit_code == 0, done.output
    assert "tube: radial displacement of the bore, mm; in brackets % from the reference" in done.output
    assert "axisymmetric, level 2" in done.output
    assert "tolerance 0.1 %: met" in done.output


def test_json_of_solve_is_read_by_programs(tube: tuple[Path, Path]) -> None:
    content = json.loads(invoke("solve", tube[0], "--out", tube[1], "--json").output)
    assert content["reached"] is True and content["verdict"].startswith("tolerance 0.1 %: met")
    finest = [r for r in content["rows"] if r["level"] == "r2"]
    # the scene's tolerance
    assert all(abs(r["error_percent"]) < 0.1 for r in finest) and len(finest) == 3


def test_a_table_shows_what_was_not_reached_and_other_models_from_the_best() -> None:
    rows = [
        row("a", "tip_mm", "mm", 5.0, "closed_form", 8.0),
        row("a", "tip_mm", "mm", 5.0, "closed_form_printed", 7.0),
        row("a", "tip_mm", "mm", 5.0, "axisymmetric", 9.0, "r1"),
        row("a", "tip_mm", "mm", 5.0, "axisymmetric", 10.0, "r2", 0.01),
        row("a", "tip_mm", "mm", 9.0, "axisymmetric", float("nan"), "r2", status="stopped at 7 kPa: law"),
    ]
    table, against = answers("tip_mm", rows)
    assert against == "axisymmetric"
    cells = [list(column.cells) for column in table.columns]
    assert [str(column.header) for column in table.columns] == ["kPa", "closed form", "axisymmetric, level 2"]
    assert cells == [["5", "9"], ["8 (−20.0)", "–"], ["10 ± 0.01", "stopped at 7 kPa"]]


def test_check_names_every_fault(tube: tuple[Path, Path], tmp_path: Path) -> None:
    assert invoke("check", tube[0]).output == "tube: sound\n"
    bad = tmp_path / "bad.toml"
    bad.write_text(tube[0].read_text(encoding="utf-8").replace("inner_radius_mm", "inner_mm"), encoding="utf-8")
    done = invoke("check", tube[0], bad)
    assert done.exit_code == 2 and "inner_mm" in done.output


def test_mesh_prints_size_quality_and_surfaces(root: Path, tmp_path: Path) -> None:
    out = tmp_path / "mesh.vtu"
    done = invoke("mesh", root / "scenes" / "smoke-t2-ri5.toml", "--out", out)
    assert done.exit_code == 0 and "quadrilateral cells" in done.output and "surface cavity:" in done.output
    assert out.stat().st_size > 1000
    body = invoke("mesh", root / "scenes" / "smoke-t2-ri5.toml", "--model", "sector").output
    assert "hexahedron cells" in body and "surface start:" in body


def test_mesh_of_a_simple_body_or_of_no_mesh_is_refused(tube: tuple[Path, Path], tmp_path: Path) -> None:
    assert invoke("mesh", tube[0]).exit_code == 2
    broken = tmp_path / "broken.msh"
    broken.write_text("nothing", encoding="utf-8")
    done = invoke("mesh", broken)
    assert done.exit_code == 2 and "broken.msh" in done.output
