"""The setup in the paper study's report: from scenes, laws and meshes, and true of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra
from solvers.discrete.elements import usual_element
from studies.paper.cases import REFERENCE
from studies.paper.drawing import meshes, outline
from studies.paper.setup import discretisation, silicones, sizes
from studies.report.tables import Table
from studies.scene.bellows import shape_of
from studies.scene.meshes import cell_kind, scene_body, scene_meridian

FIRST = REFERENCE[0].name


def column(table: Table, header: str, key: str) -> str:
    """Cell of the first line that begins or goes on with the key."""
    line = next(line for line in table.rows if key in line[:2])
    return line[table.header.index(header)]


def test_every_size_has_the_origin_that_its_scene_file_states() -> None:
    table = sizes.dimensions()
    assert column(table, "origin", "t") == "printed"
    assert column(table, "origin", "R_i") == "printed, inferred, printed, inferred"
    assert {column(table, "origin", letter) for letter in ("R_p", "e", "n")} == {"inferred"}
    assert {column(table, "origin", letter) for letter in ("seat", "fillet", "collar", "cap", "ring")} == {"chosen"}
    for actuator in REFERENCE:
        # what a line does not say is chosen only because the head of the file says so
        head = sizes.scene_file(actuator.name).partition("name =")[0]
        assert "the rest is chosen" in " ".join(head.replace("#", "").split())


def test_an_origin_is_read_off_its_own_line() -> None:
    text = "wall_mm = 2.0   # t (printed)\nseat_mm = 4.0\ncap_mm = 5.0  # (inferred)\n# fillet_mm = 1 (printed)\n"
    found = sizes.origins(text)
    assert (found["wall_mm"], found["seat_mm"], found["cap_mm"], found["fillet_mm"]) == (
        "printed",
        "chosen",
        "inferred",
        "chosen",
    )


def test_the_zigzag_differs_in_fillet_and_seat_alone() -> None:
    near = [line for line in sizes.dimensions().rows if line[1].endswith(": zigzag outline") and line[0]]
    assert [(line[0], *line[2:6]) for line in near] == [("seat", *["0.5"] * 4), ("fillet", *["0.1"] * 4)]


def test_the_centreline_is_longer_than_the_straight_wall_and_nears_it() -> None:
    for actuator in REFERENCE:
        moulded, zigzag = (
            sizes.centreline_mm(shape_of(sizes.scene_of(actuator.name, of))) for of in ("", sizes.ZIGZAG)
        )
        assert actuator.dimensions.side_length_mm < zigzag < moulded
    # arcs of 90 degrees and straight sides: the centreline of the whole outline by hand
    shape = replace(shape_of(sizes.scene_of("heung-t2-ri5")), convolutions=1)
    assert sizes.centreline_mm(shape) == pytest.approx(2.0 + np.pi * 1.5 + 2.5, rel=1e-12)


def test_constants_of_the_silicones_are_those_of_the_laws() -> None:
    (soft, eq3, eq20) = silicones.silicones().rows
    assert soft[3] == "72"
    assert (eq3[3], eq20[3]) == ("75.45", "220.2")
    # uniaxial, nominal, at stretch 2: Ogden k alpha (2^(alpha - 1) - 2^(-alpha / 2 - 1)); k alpha = 2 mu / alpha or mu
    slope = 2.0 ** (5.836 - 1.0) - 2.0 ** (-0.5 * 5.836 - 1.0)
    assert (eq3[4], eq20[4]) == (f"{2.0 * 75.449 / 5.836 * slope:.0f}", f"{75.449 * slope:.0f}")
    # Yeoh: 2 (2 - 1/4) W1 with I1 - 3 = 2
    w1 = 36.0 + 2.0 * 2.5 * 2.0 + 3.0 * 0.23 * 4.0
    assert silicones.at_double_length_kpa(DRAGON_SKIN_10) == pytest.approx(3.5 * w1, rel=1e-9)


def test_the_makers_number_picks_the_nearer_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    assert silicones.makers_modulus().endswith("supports 2μ/α².")
    stiff = silicones.at_double_length_kpa(dragon_skin_30("mu/alpha"))
    monkeypatch.setattr(silicones, "MAKERS_MODULUS_KPA", 0.9 * stiff)
    assert silicones.makers_modulus().endswith("supports μ/α.")


def test_cells_have_the_nodes_that_the_table_names() -> None:
    scene = sizes.scene_of(FIRST)
    assert cell_kind(scene) == "quadrilaterals"
    meridian = scene_meridian(scene, 1)
    tets = scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"element": "tet"})})
    triangles = scene_meridian(tets, 1)
    bodies = (scene_body(meridian, "full3d", 6), scene_body(triangles, "full3d", 6))
    for mesh in (meridian, triangles, *bodies):
        name = {"hexahedron": "hexahedra", "tetrahedron": "tetrahedra"}.get(mesh.cell.name, f"{mesh.cell.name}s")
        (line,) = (line for line in discretisation.elements().rows if line[1].startswith(f"{name} of"))
        assert f"of {mesh.cells.shape[1]} nodes" in line[1]
        assert line[4] == usual_element(mesh.cell.name).name


def test_each_level_divides_every_cell_along_both_directions() -> None:
    first, second, fourth = (line[1:] for line in discretisation.meridians().rows)
    for one, two, four in zip(first, second, fourth, strict=True):
        plain = (text.replace("\N{NARROW NO-BREAK SPACE}", "").split(" / ") for text in (one, two, four))
        (through, cells), (through_2, cells_2), (through_4, cells_4) = (map(int, parts) for parts in plain)
        assert (through_2, through_4) == (2 * through, 4 * through)
        assert (cells_2, cells_4) == (4 * cells, 16 * cells)


def test_pictures_are_drawn(tmp_path: Path) -> None:
    assert outline.draw_outlines(tmp_path / "outline.png", FIRST) == ""
    assert meshes.draw_meshes(tmp_path / "mesh.png", "heung-t2-ri7") == ""
    assert all((tmp_path / name).stat().st_size > 10_000 for name in ("outline.png", "mesh.png"))


def test_faces_of_a_body_close_it() -> None:
    scene = sizes.scene_of("heung-t2-ri7")
    body = revolve_hexahedra(scene_meridian(scene, 1), 6, 0.75 * FULL_CIRCLE)
    patches, edges = meshes.faces_of(body)
    # every edge of a patch within or at the border of its face belongs to two patches: the surface is closed
    ends = np.stack([patches, np.roll(patches, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    middles = np.round(ends.mean(axis=1), 6)
    _, counts = np.unique(middles, axis=0, return_counts=True)
    assert set(counts) == {2}
    # 4 by 4 patches in a face, and 4 strokes along each of its sides
    assert len(edges) == len(patches)
