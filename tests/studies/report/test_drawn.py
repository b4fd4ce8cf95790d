"""Pictures are drawn once, and again when what they show changes; they stay valid PNGs."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from matplotlib.image import imread

from studies.report import drawn
from studies.report.drawn import key_of, once
from studies.report.style import figure_file
from studies.results import rows
from studies.results.rows import row


class Painter:
    """Draws a small picture and counts."""

    def __init__(self, path: Path, why: str = "") -> None:
        self.path, self.why, self.times = path, why, 0

    def __call__(self) -> str:
        self.times += 1
        if not self.why:
            with figure_file(self.path, 1.0, 1.0) as figure:
                figure.add_subplot().plot([0.0, 1.0], [0.0, self.times])
        return self.why


def test_drawn_once(tmp_path: Path) -> None:
    path = tmp_path / "pictures" / "x.png"
    painter = Painter(path)
    assert once(path, "a", painter) == once(path, "a", painter) == ""
    assert painter.times == 1
    once(path, "b", painter)
    once(path, "b", painter)
    assert painter.times == 2
    assert list(path.parent.iterdir()) == [path]


def test_the_picture_is_the_one_drawn(tmp_path: Path) -> None:
    path, other = tmp_path / "x.png", tmp_path / "y.png"
    once(path, "a", Painter(path))
    Painter(other)()
    assert np.array_equal(imread(path), imread(other))


def test_no_picture_is_tried_again_and_no_old_one_stays(tmp_path: Path) -> None:
    path = tmp_path / "x.png"
    once(path, "a", Painter(path))
    failing = Painter(path, "no graphics")
    assert once(path, "b", failing) == once(path, "b", failing) == "no graphics"
    assert failing.times == 2 and not path.exists()


def test_a_damaged_or_foreign_picture_is_drawn_anew(tmp_path: Path) -> None:
    path = tmp_path / "x.png"
    painter = Painter(path)
    for content in (b"", b"not a picture"):
        path.write_bytes(content)
        assert once(path, "a", painter) == ""
    assert painter.times == 2


def test_key_depends_on_rows_files_and_code(tmp_path: Path) -> None:
    file = tmp_path / "fields.vtu"
    entry = row("s", "tip_mm", "mm", 5.0, "full3d", 1.0)
    keys = {key_of(entry, files=[file])}
    file.write_text("one")
    keys.add(key_of(entry, files=[file]))
    assert key_of(entry, files=[file]) in keys
    os.utime(file, ns=(1, 1))
    keys.add(key_of(entry, files=[file]))
    keys.add(key_of(row("s", "tip_mm", "mm", 5.0, "full3d", 1.1), files=[file]))
    keys.add(key_of(entry, files=[file], code=[rows]))
    keys.add(key_of(entry, files=[file], code=[rows, drawn]))
    assert len(keys) == 6
