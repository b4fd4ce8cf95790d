"""The HTML page in a headless Chromium, where there is one: its scripts run, the body turns up, nothing is too wide."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from tests.studies.report.test_report_html import MARKDOWN, VIEW, bodies, keep_run, tube_scene, written

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), "")
OPTIONS = ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
# Faults of scripts end up in the page, where `--dump-dom` shows them.
WATCH = "<script>addEventListener('error', (e) => document.documentElement.dataset.fault = e.message)</script>"

pytestmark = pytest.mark.skipif(not CHROMIUM, reason="no Chromium: apt-get install chromium")


@pytest.fixture(scope="module")
def page(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("pyvista")
    folder = tmp_path_factory.mktemp("page")
    keep_run(folder, bodies()["hexahedra"], tube_scene(root))
    with pytest.MonkeyPatch.context() as patch:
        written(folder, VIEW + MARKDOWN.replace("| one |", "| two | 20 |\n| one |"), patch)
    return folder / "report.html"


def browse(page: Path, name: str, script: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Open a page that also runs a script, after its own."""
    text = page.read_text(encoding="utf-8").replace("<head>", f"<head>{WATCH}", 1)
    variant = page.with_name(f"{name}.html")
    variant.write_text(text.replace("</body>", f"<script>{script}</script></body>"), encoding="utf-8")
    home = f"--user-data-dir={page.parent / 'chromium'}"
    command = [CHROMIUM, *OPTIONS, home, "--virtual-time-budget=5000", *options, variant.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=240)


def picture(page: Path, pressure_kpa: float) -> np.ndarray:
    """What is seen of the 3D view at a pressure."""
    name = f"at{pressure_kpa:g}"
    script = (
        "const view = document.querySelector('figure.view3d');"
        "const slider = view.querySelector('.view3d-pressure input');"
        f"slider.value = {pressure_kpa}; slider.dispatchEvent(new Event('input', {{bubbles: true}}));"
    )
    file = page.with_name(f"{name}.png")
    browse(page, name, script, f"--screenshot={file}", "--window-size=1200,900", "--hide-scrollbars")
    return np.asarray(imread(file))[..., :3]


def test_the_body_is_seen_and_changes_with_the_pressure(page: Path) -> None:
    rest, full = picture(page, 0.0), picture(page, 10.0)
    coloured = [(np.ptp(image, axis=2) > 0.25).sum() for image in (rest, full)]
    assert min(coloured) > 2000  # yellow to red, in a page that is grey and blue
    assert (np.abs(rest - full).max(axis=2) > 0.1).sum() > 2000


def test_scripts_run_without_faults_and_tables_sort(page: Path) -> None:
    script = (
        "const box = document.querySelector('div.table');"
        "(box.querySelector('th:last-child button') ?? box.querySelector('th:last-child')).click();"
    )
    dom = browse(page, "sorted", script, "--dump-dom").stdout
    assert "data-fault" not in dom.split("<body", 1)[0]
    assert 'aria-sort="ascending"' in dom
    cells = re.findall(r"<td[^>]*>([^<]+)</td>", dom)
    assert cells.index("20") < cells.index("149.39 ± 0.77")
    assert "tip" in re.findall(r"<output[^>]*>(.*?)</output>", dom)[0]


@pytest.mark.parametrize("width", [420, 1300])
def test_nothing_is_wider_than_the_window(page: Path, width: int) -> None:
    script = "document.documentElement.dataset.wide = document.documentElement.scrollWidth - innerWidth"
    dom = browse(page, f"wide{width}", script, "--dump-dom", f"--window-size={width},900").stdout
    (over,) = re.findall(r'data-wide="(-?\d+)"', dom)
    assert int(over) <= 0
