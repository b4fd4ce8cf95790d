"""The report shows the rows and runs it is given: numbers, uncertainties, stops, and nothing from elsewhere."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread as read_png
from numpy.typing import NDArray

from studies.engine import Solved, render
from studies.report.labels import run_label
from studies.report.numbers import MISSING
from studies.report.pictures.child import draw_states
from studies.report.pictures.stills import RingBox, Still
from studies.report.scene_report import SceneReport, headline
from studies.report.scenes import verdict
from studies.report.tables import Column, per_level, pivot, pressure_of
from studies.results.rows import Row, read_rows, row
from studies.results.run_files import PathRow, RunSummary, read_path
from studies.smoke.study import STUDY, cases

PRESSURES = (10.0, 20.0)
AXISYMMETRIC = {"r1": (50.343, 74.620), "r2": (50.242, 74.485), "r4": (50.222, 74.442)}
FULL = {"n8": (50.502, 74.911), "n16": (50.361, 74.657)}
REASON = "the step became smaller than 1e-4 of the cavity (a < b | c)"
PAPER = "Heung et al., Biomimetics 2024, 9, 160"


def run(scene: str, model: str, level: str) -> RunSummary:
    return RunSummary(
        scene=scene,
        model=model,
        level=level,
        status="reached",
        reason="",
        content_hash="0",
        plan=("ring interiors: rigid rings are within the tolerance",),
        dofs=24601,
        cells=1234,
        nodes=2345,
        factorisations=17,
        newton_iterations=43,
        rejected_steps=1,
        silicone_g=18.62,
        ring_g=5.9,
        time_s={"mesh": 1.0, "factor": 2.5, "total": 4.25},
        peak_mb=321.0,
        versions={"dolfinx": "0.5.2"},
        blas="OpenBLAS 0.3.21",
        ranks=2,
        threads=1,
        commit="c745eaf",
        when="2026-01-04T10:00:00",
    )


def state(pressure: float, tip: float, modes: int = 0, asked: bool = True) -> PathRow:
    status = "requested" if asked else "step"
    return PathRow(pressure, "volume", tip, tip, 0.0, 1.0, 1.0, 1.0, 0.9, math.nan, modes, "", 4, 1.0, status, 0.01)


def make_scene(name: str = "demo-scene", stop_kpa: float = math.inf) -> SceneReport:
    """A scene whose full 3D runs stop at ``stop_kpa``."""
    rows: list[Row] = []
    for place, pressure in enumerate(PRESSURES):

        def tip(model: str, value: float, level: str = "", pressure: float = pressure, **more: float) -> Row:
            return row(name, "tip_mm", "mm", pressure, model, value, level, **more)  # type: ignore[arg-type]

        rows.append(tip("closed_form", (39.1, 53.25)[place]))
        rows.append(tip("closed_form_seat", (58.0, 82.5)[place]))
        for level, values in AXISYMMETRIC.items():
            bound = 0.0131 if level == "r4" else math.nan
            rows.append(tip("axisymmetric", values[place], level, uncertainty=bound))
        for level, values in FULL.items():
            if pressure <= stop_kpa:
                bound = 0.25 if level == "n16" else math.nan
                rows.append(tip("full3d", values[place], level, uncertainty=bound))
            else:
                stopped = tip("full3d", math.nan, level)
                rows.append(replace(stopped, status=f"stopped at {stop_kpa:g} kPa: {REASON}"))
        rows.append(row(name, "tip_centre_mm", "mm", pressure, "axisymmetric", 77.77, "r4", uncertainty=0.02))
    for model, value in (("paper_closed_form", 53.0), ("paper_ansys", 33.0), ("paper_experiment", 50.0)):
        rows.append(row(name, "tip_mm", "mm", 20.0, model, value, source=PAPER))
    rows.append(row(name, "silicone_g", "g", math.nan, "axisymmetric", 18.62, "r4", reference=19.0, source=PAPER))
    full = [state(p, tip) for p, tip in zip(PRESSURES, FULL["n16"], strict=True) if p <= stop_kpa]
    return SceneReport(
        name=name,
        title="t = 2 mm",
        scene_toml='name = "demo-scene"  # arcs & <folds>\n',
        pressures_kpa=PRESSURES,
        rows=tuple(rows),
        runs=(run(name, "axisymmetric", "r4"), run(name, "full3d", "n16")),
        paths={
            "axisymmetric r4": [state(5.0, 32.1, asked=False), state(10.0, 50.222), state(20.0, 74.442, 2)],
            "full3d n16": full,
        },
        fields={},
        notes=("Sector runs were skipped: nobody asked.",),
    )


def report(folder: Path, *scenes: SceneReport) -> tuple[str, str]:
    """Markdown and HTML of a report."""
    (case,) = cases({})
    assert render(STUDY, folder, [Solved(case, scene) for scene in scenes]) == 0
    return (folder / "report.md").read_text(encoding="utf-8"), (folder / "report.html").read_text(encoding="utf-8")


def table(text: str, heading: str) -> list[dict[str, str]]:
    """First Markdown table below a line that starts with ``heading``, a dictionary per row."""
    lines = iter(text.split(heading, 1)[1].splitlines())
    found: list[list[str]] = []
    for line in lines:
        if line.startswith("|"):
            found.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
        elif found:
            break
    header, _, *body = found
    assert all(len(cells) == len(header) for cells in body)
    return [dict(zip(header, cells, strict=True)) for cells in body]


def test_side_by_side_table_has_every_model_with_its_uncertainty(tmp_path: Path) -> None:
    text, _ = report(tmp_path, make_scene())
    low, high = table(text, "### Elongation by pressure and model")
    assert low["pressure, kPa"] == "10"
    assert low["axisymmetric"] == "50.22 ± 0.02"  # rounded up
    assert low["paper: ANSYS"] == "–"
    assert high["closed form"] == "53.25"
    assert high["closed form, free pitch"] == "82.50"
    assert high["full 3D"] == "74.66 ± 0.25"
    assert [high[f"paper: {what}"] for what in ("closed form", "ANSYS", "experiment")] == ["53", "33", "50"]
    assert (low["unstable modes, axisymmetric"], high["unstable modes, axisymmetric"]) == ("0", "2")
    assert "first state with 2 unstable at 20 kPa" in text


def test_differences_are_against_full_3d(tmp_path: Path) -> None:
    text, _ = report(tmp_path, make_scene())
    _, high = table(text, "Differences, in percent")
    assert high["compared with"] == "full 3D"
    assert high["closed form"] == "−28.7"  # 100 (53.25 - 74.657) / 74.657
    assert high["axisymmetric"] == "−0.29"
    assert high["paper: experiment"] == "−33.0"


def test_stopped_rows_are_shown_with_their_reason(tmp_path: Path) -> None:
    scene = make_scene(stop_kpa=12.3)
    text, page = report(tmp_path, scene)
    _, high = table(text, "### Elongation by pressure and model")
    assert high["full 3D"] == "stopped at 12.3 kPa"
    assert high["unstable modes, full 3D"] == "–"
    _, difference = table(text, "Differences, in percent")
    assert (difference["compared with"], difference["axisymmetric"]) == ("axisymmetric", "–")
    assert "full 3D, 8 cells round and 16 cells round, asked for 20 kPa: stopped at 12.3 kPa" in text
    assert "(a &lt; b | c)" in page.replace("\\|", "|")
    assert "## Summary" not in text and "at 1 of 2 pressures" in text  # one scene is its own summary
    line, _ = table(report(tmp_path, scene, replace(scene, name="another"))[0], "## Summary")
    assert line["full 3D"] == "stopped at 12.3 kPa"
    assert line["status"] == "full 3D, 8 cells round and 16 cells round stopped at 12.3 kPa"
    assert "at 1 of 2 pressures" in line["verdict"]


def test_without_full_3d_the_axisymmetric_model_is_the_reference(tmp_path: Path) -> None:
    scene = make_scene()
    scene = replace(scene, rows=tuple(r for r in scene.rows if r.model != "full3d"), paths={}, runs=())
    text, _ = report(tmp_path, scene)
    low, _ = table(text, "Differences, in percent")
    assert low["compared with"] == "axisymmetric"
    assert low["closed form"] == "−22.1"
    assert "full 3D" not in low
    assert "### Run time" not in text


def test_verdict_bounds_the_difference_and_weighs_the_uncertainties() -> None:
    scene = make_scene()
    # 100 (74.657 - 74.442) / 74.657 = 0.288, and 0.215 mm against 0.25 + 0.0131 mm
    assert verdict(scene) == "axisymmetric within 0.29 % of full 3D, within the sum of their uncertainties"
    sure = tuple(replace(r, uncertainty=0.1) if r.model == "full3d" else r for r in scene.rows)
    assert verdict(replace(scene, rows=sure)).endswith("beyond the sum of their uncertainties")
    unknown = tuple(replace(r, uncertainty=math.nan) for r in scene.rows)
    assert verdict(replace(scene, rows=unknown)) == "axisymmetric within 0.29 % of full 3D"


def test_headline_is_the_finest_level_also_when_it_stopped() -> None:
    scene = make_scene()
    finest = headline(scene, "axisymmetric", 20.0)
    assert finest is not None and finest.level == "r4"
    stopped = headline(make_scene(stop_kpa=12.3), "full3d", 20.0)
    assert stopped is not None and stopped.level == "n16" and math.isnan(stopped.value)
    assert headline(scene, "sector", 20.0) is None


def test_convergence_lists_levels_coarse_to_fine_with_their_size(tmp_path: Path) -> None:
    text, _ = report(tmp_path, make_scene())
    lines = table(text, "### Convergence with the mesh")
    assert [line["model"] for line in lines] == [
        *(f"axisymmetric, level {refinement}" for refinement in (1, 2, 4)),
        "uncertainty of axisymmetric, level 4",
        *(f"full 3D, {cells} cells round" for cells in (8, 16)),
        "uncertainty of full 3D, 16 cells round",
    ]
    assert [line["at 20 kPa, mm"] for line in lines[:4]] == ["74.620", "74.485", "74.442", "± 0.014"]
    assert lines[2]["cells"].replace("\N{NARROW NO-BREAK SPACE}", "") == "1234"
    assert lines[0]["cells"] == "–"  # no run given for it


def test_other_quantities_masses_and_times(tmp_path: Path) -> None:
    text, _ = report(tmp_path, make_scene())
    centre, mass = table(text, "### Other quantities")
    assert (centre["quantity"], centre["20 kPa"]) == ("axial displacement of the tip's centre, mm", "77.77 ± 0.02")
    assert (mass["any pressure"], mass["compared with"]) == ("18.62 (−2.0 % from 19)", PAPER)
    meshes, printed = table(text, "### Masses")
    assert (meshes["mesh"], meshes["silicone, g"]) == ("axisymmetric, level 4; full 3D, 16 cells round", "18.62")
    assert (printed["silicone, g"], printed["together, g"]) == ("19", "")
    seconds = table(text, "### Run time")[0]
    assert (seconds["factor"], seconds["other"], seconds["total"]) == ("2.5", "0.8", "4.2")
    assert "Sector runs were skipped" in text
    assert (
        "ring interiors: rigid rings are within the tolerance (axisymmetric, level 4; full 3D, 16 cells round)" in text
    )


def test_other_quantities_are_written_in_their_own_way(tmp_path: Path) -> None:
    scene = make_scene()

    def other(quantity: str, unit: str, value: float) -> Row:
        return row(scene.name, quantity, unit, 20.0, "full3d", value, "n16")

    more = (
        other("unstable_modes", "1", 12.0),
        other("min_det_f", "1", 0.88996),
        other("axisymmetric_full3d_gap_percent", "%", 0.2549),
        other("unstable_modes", "1", math.nan),
    )
    text, _ = report(tmp_path, replace(scene, rows=(*scene.rows, *more[:3])))
    found = {line["quantity"]: line for line in table(text, "### Other quantities")}
    assert found["unstable modes"]["20 kPa"] == "12"
    assert found["least det F"]["20 kPa"] == "0.890"
    assert found["gap between axisymmetric and full 3D, %"]["20 kPa"] == "0.2549"
    assert (found["least det F"]["compared with"], found["mass of the silicone, g"]["compared with"]) == ("–", PAPER)
    text, _ = report(tmp_path, replace(scene, rows=(*scene.rows[:-1], more[3])))  # without the compared mass
    centre, modes = table(text, "### Other quantities")
    assert list(centre) == ["quantity", "model", "10 kPa", "20 kPa"]
    assert modes["20 kPa"] == "–"  # not counted


def test_what_computed_rows_are_compared_with_is_not_called_printed(tmp_path: Path) -> None:
    scene = make_scene()
    rows = (replace(r, reference=74.657, source="full3d n16") if r.pressure_kpa == 20.0 else r for r in scene.rows)
    text, _ = report(tmp_path, replace(scene, rows=tuple(rows)))
    section = text.split("### Elongation by pressure and model")[1].split("### Shape")[0]
    assert "full3d n16" not in section and "Printed" not in section


def test_each_note_is_written_once(tmp_path: Path) -> None:
    scene = make_scene()
    text, _ = report(tmp_path, replace(scene, notes=(*scene.notes, *scene.notes, *scene.runs[0].plan)))
    notes = text.split("### Skipped and noted")[1].split("### Files")[0].split("\n- ")[1:]
    assert [note.strip() for note in notes] == [
        "Sector runs were skipped: nobody asked.",
        "ring interiors: rigid rings are within the tolerance (axisymmetric, level 4; full 3D, 16 cells round)",
    ]


def test_a_reference_other_than_the_best_model_is_shown(tmp_path: Path) -> None:
    scene = make_scene()
    peer = row("demo-scene", "tip_mm", "mm", 20.0, "peer_febio", 75.0, reference=70.0, source="its manual")
    text, _ = report(tmp_path, replace(scene, rows=(*scene.rows, peer)))
    (line,) = table(text, "Comparison with other references")
    assert (line["model"], line["error, %"], line["source of the reference"]) == (
        "peer febio",
        "+7.1",
        "its manual",
    )
    assert "Comparison with other references" not in report(tmp_path, scene)[0]


def test_html_is_self_contained_and_escapes_what_it_shows(tmp_path: Path) -> None:
    text, page = report(tmp_path, make_scene(), make_scene("second"))
    sources = re.findall(r'src="([^"]{0,40})', page)
    assert sources and all(source.startswith("data:image/png;base64,") for source in sources)
    assert not re.search(r'(src|href)="(https?:)?//', page)
    assert "<script src" not in page and "<link" not in page
    assert "<table>" in page and page.count("<table>") == text.count("\n| ---:") + text.count("\n| :---")
    details = page.split("<details>")[1].split("</details>")[0]
    assert "arcs &amp; &lt;folds&gt;" in details and "<code" in details
    assert 'href="#second"' in page and 'id="second"' in page


def test_markdown_pictures_and_links_exist(tmp_path: Path) -> None:
    text, _ = report(tmp_path, make_scene(stop_kpa=12.3), make_scene("second"))
    addresses = [a for a in re.findall(r"\]\(([^)]+)\)", text) if not a.startswith("#")]
    assert "pictures/overview.png" in addresses and "rows.csv" in addresses
    assert all((tmp_path / address).is_file() for address in addresses)
    states = read_path(tmp_path / "paths/demo-scene/axisymmetric-r4")
    assert [state.tip_mm for state in states] == [32.1, 50.222, 74.442]


def test_meshes_are_spelled_out() -> None:
    assert run_label("full3d", "n8r2") == "full 3D, 8 cells round, level 2"
    assert run_label("axisymmetric", "r4") == "axisymmetric, level 4"
    assert run_label("full3d", "n16") == "full 3D, 16 cells round"
    assert run_label("full3d", "n2", counted="along an edge") == "full 3D, 2 cells along an edge"
    assert run_label("full3d", "m1") == "full 3D, m1"
    assert run_label("axisymmetric", "r1", "r2", "r4") == "axisymmetric, level 1, level 2 and level 4"
    assert run_label("closed_form", "") == run_label("closed_form") == "closed form"


def test_rows_become_a_table() -> None:
    def tip(pressure: float, level: str, value: float) -> Row:
        return row("x", "tip_mm", "mm", pressure, "axisymmetric", value, level)

    rows = [tip(5.0, "r1", 1.23456), tip(5.0, "r2", 1.25), tip(10.0, "r1", math.nan)]
    rows.append(row("x", "unstable_modes", "1", 10.0, "axisymmetric", 3.0, "r2"))
    rows.append(row("x", "crossing_kpa", "kPa", math.nan, "axisymmetric", 7.0, "r2"))
    columns = [*per_level("tip, mm", "tip_mm", ".3g", ("r1", "r2")), Column("modes", "unstable_modes", ".0f")]
    shown = pivot(rows, {"kPa": pressure_of}, columns)
    assert shown.header == ("kPa", "tip, mm: level 1", "tip, mm: level 2", "modes")
    assert shown.rows == (("5", "1.23", "1.25", MISSING), ("10", MISSING, MISSING, "3"))


def test_rows_csv_has_all_rows_of_all_scenes(tmp_path: Path) -> None:
    scenes = (make_scene(stop_kpa=12.3), make_scene("second"))
    report(tmp_path, *scenes)
    written = read_rows(tmp_path / "rows.csv")
    given = [entry for scene in scenes for entry in scene.rows]
    assert len(written) == len(given)
    for one, other in zip(written, given, strict=True):
        for name in Row.__dataclass_fields__:
            expected = getattr(other, name)
            if isinstance(expected, float):
                assert getattr(one, name) == pytest.approx(expected, rel=1e-8, nan_ok=True)
            else:
                assert getattr(one, name) == expected


def test_a_missing_field_file_leaves_a_line_instead_of_the_picture(tmp_path: Path) -> None:
    scene = replace(make_scene(), fields={20.0: tmp_path / "gone.vtu"})
    text, _ = report(tmp_path / "out", scene)
    assert "No picture: no such file" in text
    assert "-states.png" not in text


def write_body(path: Path) -> None:
    """Two tetrahedra of ten nodes each, 20 mm long, with the fields of a run."""
    pyvista = pytest.importorskip("pyvista")
    corners = np.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [-2.0, 4.0, 0.0], [0.0, 0.0, 20.0]])
    corners = np.vstack([corners, corners[[0, 2, 1, 3]] * [1.0, -1.0, 1.0]])  # its mirror image
    cells = []
    points = list(corners)
    for first in (0, 4):
        pairs = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
        middles = [0.5 * (corners[first + i] + corners[first + j]) for i, j in pairs]
        cells.append([*range(first, first + 4), *range(len(points), len(points) + 6)])
        points += middles
    body = pyvista.UnstructuredGrid({24: np.array(cells)}, np.array(points))
    body["displacement_mm"] = 0.1 * body.points
    body["stretch_max"] = 1.0 + 0.01 * body.points[:, 2]
    body.cell_data["region"] = np.array([1, 3])
    body.save(path)


@pytest.mark.slow
def test_pictures_are_drawn_in_a_child_whose_failure_is_told(tmp_path: Path) -> None:
    write_body(tmp_path / "body.vtu")
    stills = [Still("unloaded", tmp_path / "body.vtu", deformed=False), Still("20 kPa", tmp_path / "body.vtu")]
    assert draw_states(tmp_path / "pictures/body.png", stills) == ""
    assert (tmp_path / "pictures/body.png").stat().st_size > 10_000
    (tmp_path / "broken.vtu").write_text("not a VTU file", encoding="utf-8")
    assert "drawing failed" in draw_states(tmp_path / "no.png", [Still("20 kPa", tmp_path / "broken.vtu")])
    assert not (tmp_path / "no.png").exists()


@pytest.mark.slow
def test_rigid_rings_are_drawn_where_they_are_given(tmp_path: Path) -> None:
    write_body(tmp_path / "body.vtu")
    scene = replace(make_scene(), fields={20.0: tmp_path / "body.vtu"})
    bare, _ = report(tmp_path / "bare", scene)
    assert "(rigid ones) are not drawn" in bare
    rings: dict[float, tuple[RingBox, ...]] = {
        0.0: (RingBox(10.0, 6.0, 4.0, 2.0),),
        20.0: (RingBox(11.0, 6.0, 4.0, 2.0),),
    }
    text, _ = report(tmp_path / "rings", replace(scene, rings=rings))
    assert "Grey: the rigid rings" in text and "not drawn" not in text
    picture = "pictures/demo-scene-states.png"
    grey = [int(is_grey(tmp_path / folder / picture).sum()) for folder in ("bare", "rings")]
    assert grey[1] > grey[0] + 1000


def is_grey(picture: Path) -> NDArray[np.bool_]:
    """Where a picture has the colour of a cut ring."""
    colours = np.rint(255.0 * read_png(picture)[:, :, :3])
    return np.asarray((np.abs(colours - 0xD8) <= 1.0).all(axis=2))
