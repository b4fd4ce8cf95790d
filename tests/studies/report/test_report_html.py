"""The HTML page: one file with its navigation, sections, tables, pictures, and 3D views of runs with fields."""

from __future__ import annotations

import base64
import json
import re
import zlib
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.bodies import tube_meridian
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers.state import State
from solvers.vtu import write_vtu
from studies.report import pages
from studies.report.pages import write_page
from studies.report.viewer import snippet
from studies.results.run_files import PathRow, RunSummary, field_file, save_state, write_path, write_summary

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
MARKDOWN = """# A study

Asked: what?

<a id="begin"></a>

## Begin

| actuator | elongation |
| :--- | ---: |
| one | 149.39 ± 0.77 |

![Elongation over pressure](pictures/one.png)

*Elongation of **one** actuator.*

## Same

## Same

See [the end](#end).

## Fourth, R<sub>i</sub> & all

## Detail

<details markdown="1">
<summary>More</summary>

Text.

</details>

# Appendix

Of the appendix.

<a id="end"></a>

## What it must show

## Provenance
"""
STRETCH, PRESSURES = 0.25, (5.0, 10.0)
VIEW = '<div class="view3d" data-run="scene/full3d-n8"></div>\n\n'


@dataclass
class Elements(HTMLParser):
    """Opening tags of a page, with their attributes, and what is within scripts."""

    tags: list[tuple[str, dict[str, str | None]]] = field(default_factory=list)
    scripts: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()
        self._in_script = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._in_script = tag == "script"

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False

    def handle_data(self, data: str) -> None:
        if self._in_script:
            self.scripts.append(data)

    def named(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


def elements(page: str) -> Elements:
    found = Elements()
    found.feed(page)
    return found


def written(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> tuple[str, str]:
    """report.md and report.html of a page whose template is that text."""
    monkeypatch.setattr(pages, "TEMPLATES", (*pages.TEMPLATES, folder))
    (folder / "page.md.j2").write_text(text, encoding="utf-8")
    (folder / "pictures").mkdir(exist_ok=True)
    (folder / "pictures/one.png").write_bytes(PIXEL)
    page = write_page(folder, "page.md.j2", {"title": "A study"})
    return (folder / "report.md").read_text(encoding="utf-8"), page.read_text(encoding="utf-8")


# --- the page -----------------------------------------------------------------------------------------------


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    return written(tmp_path, MARKDOWN, monkeypatch)[1]


def test_a_page_has_its_landmarks(page: str) -> None:
    found = elements(page)
    assert found.named("html") == [{"lang": "en"}]
    assert len(found.named("main")) == len(found.named("nav")) == len(found.named("dialog")) == 1
    main = found.named("main")[0]["id"]
    assert found.named("a")[0] == {"class": "skip", "href": f"#{main}"}


def test_ids_are_unique_and_every_address_is_there(page: str) -> None:
    found = elements(page)
    ids = [attributes["id"] for _, attributes in found.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    assert {"begin", "same", "same-2", "fourth-ri-all", "end"} <= set(ids)
    assert {a["href"] for a in found.named("a")} <= {f"#{name}" for name in ids}


def test_detail_is_folded_and_what_must_be_shown_is_not(page: str) -> None:
    sections = [a for a in elements(page).named("details") if a.get("class") == "section"]
    assert ["open" in a for a in sections] == [True, True, True, True, False, True, False]
    # the title of the appendix belongs to no section
    assert re.search(r"</details>\s*<h1>Appendix</h1>\s*<p>Of the appendix.</p>\s*<details", page)


def test_pictures_are_within_the_page_and_have_words(page: str) -> None:
    images = elements(page).named("img")
    assert [image["alt"] for image in images] == ["Elongation over pressure"]
    assert str(images[0]["src"]).startswith("data:image/png;base64,")
    assert "<figcaption>Elongation of <strong>one</strong> actuator.</figcaption>" in page


def test_tables_scroll_in_a_box_and_name_their_columns(page: str) -> None:
    assert '<div class="table"><table>' in page
    assert [th["scope"] for th in elements(page).named("th")] == ["col", "col"]


def test_nothing_comes_from_elsewhere(page: str) -> None:
    found = elements(page)
    assert not found.named("link") and all("src" not in script for script in found.named("script"))
    assert not re.search(r"@import|url\(|fetch\(|XMLHttpRequest|(src|href)=\"(https?:)?//", page)
    assert not re.search(r"figure class=.view3d|THREE", page)  # which only a page with a view needs


# --- 3D views -----------------------------------------------------------------------------------------------


def bodies() -> dict[str, SolidMesh]:
    """A short tube in hexahedra and in tetrahedra."""
    return {
        "hexahedra": revolve_hexahedra(tube_meridian(2.0, 3.0, 4.0, 1, 1, "quadrilaterals"), 8),
        "tetrahedra": revolve(tube_meridian(2.0, 3.0, 4.0, 1, 1, "triangles"), 8),
    }


def keep_run(folder: Path, body: SolidMesh, scene: str, rings: int = 0, turned_mm: float = 0.0) -> None:
    """A run that has stretched a body along its axis, by `STRETCH` at the highest pressure."""
    run = folder / "scene/full3d-n8"
    (run / "fields").mkdir(parents=True)
    (run / "states").mkdir()
    (folder / "scene/scene.toml").write_text(scene, encoding="utf-8")
    rows = []
    for pressure in PRESSURES:
        share = STRETCH * pressure / PRESSURES[-1]
        moved = share * body.points * [0.0, 0.0, 1.0]
        motions = np.tile([0.0, 0.0, share, turned_mm, 0.0, 0.0], (rings, 1))
        state = State(moved, np.zeros(len(body.points)), motions, 1e-3 * pressure)
        row = PathRow(
            pressure, "volume", share, share, 0.0, 1.0, 1.0, 1.0, 0.9, np.nan, 0, "", 4, 1.0, "requested", 0.0
        )
        write_vtu(field_file(run, 1e-3 * pressure), body, state)
        save_state(run, "0", state, row)
        rows.append(row)
    write_path(run, rows)
    summary = RunSummary(
        scene="tube",
        model="full3d",
        level="n8",
        status="reached",
        reason="",
        content_hash="0",
        plan=(),
        dofs=1,
        cells=1,
        nodes=1,
        factorisations=1,
        newton_iterations=1,
        rejected_steps=0,
        silicone_g=1.0,
        ring_g=0.0,
        time_s={"total": 1.0},
        peak_mb=1.0,
        versions={},
        blas="",
        ranks=1,
        threads=1,
        commit="",
        when="",
    )
    write_summary(run, summary)


def tube_scene(root: Path) -> str:
    return (root / "scenes/exact/tube.toml").read_text(encoding="utf-8")


def payloads(page: str) -> list[dict[str, Any]]:
    return [json.loads(text) for text in elements(page).scripts if text.startswith("{")]


@dataclass(frozen=True, eq=False)
class Decoded:
    """What a browser makes of a payload: faces, positions in mm by state, stretches by state, and rigid faces."""

    faces: np.ndarray
    points: np.ndarray
    stretches: np.ndarray
    rigid: np.ndarray


def decoded(payload: dict[str, Any]) -> Decoded:
    raw = zlib.decompress(base64.b64decode(payload["data"]))
    faces, states, nodes = sum(payload["counts"]), len(payload["states"]), payload["nodes"]
    sizes = (4 * payload["face_nodes"] * faces, 6 * states * nodes, states * nodes, faces)
    assert len(raw) == sum(sizes)
    parts = [raw[end - size : end] for size, end in zip(sizes, np.cumsum(sizes), strict=True)]
    grid = np.frombuffer(parts[1], "<u2").reshape(states, 3, nodes).transpose(0, 2, 1)
    return Decoded(
        np.frombuffer(parts[0], "<u4").reshape(payload["face_nodes"], faces).T,
        np.array(payload["origin"]) + np.array(payload["step"]) * grid,
        1.0 + (payload["top"] - 1.0) * np.frombuffer(parts[2], "u1").reshape(states, nodes) / 255.0,
        np.frombuffer(parts[3], "u1"),
    )


def volume(payload: dict[str, Any], points: np.ndarray, faces: np.ndarray) -> float:
    """Of what some faces enclose, positive if they look outwards, mm3."""
    weights, pieces = np.array(payload["weights"]), np.array(payload["triangles"])
    corners = np.einsum("pn,fnc->fpc", weights, points[faces])[:, pieces]
    a, b, c = np.moveaxis(corners.reshape(-1, 3, 3), 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("cells", ["hexahedra", "tetrahedra"])
def test_a_view_holds_the_surface_of_the_body(
    cells: str, tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyvista")
    body = bodies()[cells]
    keep_run(tmp_path, body, tube_scene(root))
    text, page = written(tmp_path, VIEW + MARKDOWN, monkeypatch)
    assert text == MARKDOWN.rstrip("\n")  # report.md knows nothing of it
    (payload,) = payloads(page)
    found = decoded(payload)
    assert [state["kpa"] for state in payload["states"]] == [0.0, *PRESSURES]
    behind, before, cut = payload["counts"]
    assert behind == before > 0 and cut > 0 and not found.rigid.any()
    # every node of the surface is where the body's is, at rest and stretched
    for points, pressure in zip(found.points, [0.0, *PRESSURES], strict=True):
        there = body.points * [1.0, 1.0, 1.0 + STRETCH * pressure / PRESSURES[-1]]
        nearest = np.linalg.norm(points[:, None] - there[None], axis=2).min(axis=1)
        assert nearest.max() < 1e-3
    assert len(np.unique(np.round(found.points[0], 2), axis=0)) == payload["nodes"]
    for stretches, pressure in zip(found.stretches, [0.0, *PRESSURES], strict=True):
        assert stretches == pytest.approx(1.0 + STRETCH * pressure / PRESSURES[-1], abs=STRETCH / 255.0)
    # the faces enclose the whole body, or what is behind the cut, and look outwards
    whole, half = found.faces[: behind + before], np.delete(found.faces, np.s_[behind : behind + before], axis=0)
    exact = np.pi * (3.0**2 - 2.0**2) * 4.0
    assert volume(payload, found.points[0], whole) == pytest.approx(exact, rel=2e-2)
    assert 2.0 * volume(payload, found.points[0], half) == pytest.approx(
        volume(payload, found.points[0], whole), rel=1e-4
    )


def test_a_page_with_a_view_is_one_file_of_bearable_size(
    tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyvista")
    keep_run(tmp_path, bodies()["hexahedra"], tube_scene(root))
    _, page = written(tmp_path, MARKDOWN + "\n" + VIEW + VIEW, monkeypatch)
    found = elements(page)
    assert len(payloads(page)) == 2 and page.count("const bodySurface =") == 1
    assert not found.named("link") and all("src" not in script for script in found.named("script"))
    assert not re.search(r'(src|href)="(https?:)?//', page)
    ids = [attributes["id"] for _, attributes in found.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    assert len(page) < 1_500_000
    (figure, _) = [a for a in found.named("figure") if a.get("class") == "view3d"]
    assert figure["aria-label"] == "3D view of tube"
    assert [i["type"] for i in found.named("input")] == ["range", "range"]


def test_a_run_without_fields_has_no_view(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text, page = written(tmp_path, VIEW + MARKDOWN, monkeypatch)
    assert "view3d" not in text and "view3d" not in page


def test_a_view_that_would_make_the_page_too_large_is_left_out(
    tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyvista")
    keep_run(tmp_path, bodies()["hexahedra"], tube_scene(root))
    monkeypatch.setattr(snippet, "_MOST_BYTES", 1000)
    _, page = written(tmp_path, VIEW + MARKDOWN, monkeypatch)
    assert "left out: the page would become too large" in page and not payloads(page)


def test_rigid_rings_move_with_the_states(tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    scene = (root / "scenes/smoke-t2-ri5.toml").read_text(encoding="utf-8")
    keep_run(tmp_path, bodies()["hexahedra"], scene, rings=3, turned_mm=0.5)
    (payload,) = payloads(written(tmp_path, VIEW + MARKDOWN, monkeypatch)[1])
    seat_mm = 10.5 + 2.0
    assert [ring["inner_radius_mm"] for ring in payload["rings"]] == pytest.approx([seat_mm] * 3)
    assert payload["states"][0]["rings"] == [[0.0] * 6] * 3
    last = np.array(payload["states"][-1]["rings"])
    assert last == pytest.approx(np.tile([0.0, 0.0, STRETCH, 0.5 / seat_mm, 0.0, 0.0], (3, 1)), abs=1e-6)
