"""The index of the scene files that come with the program."""

from __future__ import annotations

from pathlib import Path

from studies.results.provenance import ROOT
from studies.scene.load import load_scene
from studies.site.markdown import cell, table


def scenes_page() -> str:
    """Markdown of the page."""
    parts = [
        "# Scene files",
        "All scenes that come with the program, by folder: what each is of, as its own title says. Any of them can be"
        " planned, solved, or copied as a start.",
    ]
    folders: dict[str, list[Path]] = {}
    for path in sorted((ROOT / "scenes").rglob("*.toml")):
        folders.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(path)
    for folder in sorted(folders):
        parts += [f"## `{folder}/`", table(("file", "title", "about"), map(_line, folders[folder]))]
    return "\n\n".join(parts) + "\n"


def _line(path: Path) -> tuple[str, str, str]:
    comment = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        comment.append(line.lstrip("# "))
    return f"`{path.name}`", cell(load_scene(path).title), cell(" ".join(comment))
