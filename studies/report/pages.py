"""A report's page: Markdown from a template, and the same as one self-contained HTML file."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import markdown
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from studies.results.run_files import write_text_atomically

_OWN = Path(__file__).parent / "templates"
# What all pages share, and a folder per study.
TEMPLATES: tuple[Path, ...] = (_OWN, Path(__file__).parents[1])
_PICTURE = re.compile(r'src="(pictures/[^"]+)"')


def write_page(folder: Path, template: str, content: Mapping[str, Any]) -> Path:
    """Write report.md and report.html into a folder that has the pictures already.

    Parameters
    ----------
    folder
        Where to.
    template
        Name of the Markdown template.
    content
        What the template shows; ``title`` is among it.

    Returns
    -------
    Path
        report.html.
    """
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"] = _cell
    text = environment.get_template(template).render(content)
    write_text_atomically(folder / "report.md", text)
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "md_in_html", "sane_lists"])
    page = environment.get_template("report.html.j2").render(
        title=content["title"],
        style=(_OWN / "report.css").read_text(encoding="utf-8"),
        body=_PICTURE.sub(lambda found: f'src="{_data_uri(folder / found[1])}"', body),
    )
    write_text_atomically(folder / "report.html", page)
    return folder / "report.html"


def _cell(text: str) -> str:
    """Text made safe for a Markdown table and for HTML."""
    text = re.sub(r"[ \t\r\n]+", " ", text).strip()
    return text.replace("&", "&amp;").replace("<", "&lt;").replace("|", "\\|")


def _data_uri(picture: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")
