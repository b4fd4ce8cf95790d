"""Every command of the README and of the tutorials, run as a reader would: page by page, in a folder of its own."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FENCE = re.compile(r"^```(sh|toml|csv|python)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
# What a reader's clone has and commands read.
SHARED = (
    *(".venv", "analytical", "bellowsx", "docs", "meshes", "packages", "pyproject.toml", "scenes", "solvers"),
    *("studies", "sweeps", "tests"),
)
QUICK = ("docs/index.md", "docs/start/first-actuator.md", "docs/start/install.md", "README.md")
SLOW = (
    *(
        f"docs/tutorials/{name}.md"
        for name in ("own-actuator", "own-mesh", "own-silicone", "reading-a-report", "sweep-on-a-cluster")
    ),
    "docs/contributing.md",
)


def steps(page: Path) -> list[tuple[str, str, str]]:
    """What a page has its reader type, in order: kind, name of the file if it is one, text."""
    text = page.read_text(encoding="utf-8")
    found = [(match[1], match[2] or "", match[3]) for match in FENCE.finditer(text)]
    if page.name == "README.md":  # its only scene is saved as my.toml, its only snippet run
        found = [
            (kind, "my.toml" if kind == "toml" else "run.py" * (kind == "python"), body) for kind, _, body in found
        ]
    return found


def follow(page: Path, folder: Path) -> None:
    """Do what a page says, in a folder that looks like a clone."""
    for name in SHARED:
        (folder / name).symlink_to(ROOT / name)
    for kind, name, body in steps(page):
        if kind == "sh":
            done = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", body], cwd=folder, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, (body, done.stdout[-2000:], done.stderr[-2000:])
        elif name:
            (folder / name).write_text(body, encoding="utf-8")
    if page.name == "README.md":
        done = subprocess.run([".venv/bin/python", "run.py"], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert (folder / "results" / "my.png").stat().st_size > 10_000


@pytest.mark.parametrize("page", QUICK)
def test_commands_of_first_pages(page: str, tmp_path: Path) -> None:
    follow(ROOT / page, tmp_path)


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("page", SLOW)
def test_commands_of_tutorials(page: str, tmp_path: Path) -> None:
    follow(ROOT / page, tmp_path)


def test_all_pages_with_commands_are_run() -> None:
    with_commands = {
        path.relative_to(ROOT).as_posix()
        for path in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
        if "```sh\n" in path.read_text(encoding="utf-8")
    }
    assert with_commands <= {*QUICK, *SLOW}
