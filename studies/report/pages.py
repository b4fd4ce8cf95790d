"""A report's page: Markdown from a template, and the same as one self-contained HTML file.

The HTML has the page's sections with their addresses, figures with their captions and tables that scroll in a box;
templates/report.html.j2 puts them together with one style sheet and one script.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import markdown
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from studies.report.viewer.snippet import with_views, without_views
from studies.results.run_files import write_text_atomically

_OWN = Path(__file__).parent / "templates"
# What all pages share, and a folder per study.
TEMPLATES: tuple[Path, ...] = (_OWN, Path(__file__).parents[1])
_PICTURE = re.compile(r'src="(pictures/[^"]+)"')

# So many sections are open at first; the verdicts on what a study must show are, wherever they stand.
_OPEN: Final = 4
_ALWAYS_OPEN: Final = "What it must show"

_HEADING: Final = re.compile(r'(?:<p><a id="([^"]+)"></a></p>\s*)?<h2>(.*?)</h2>\s*', re.DOTALL)
_FIGURE: Final = re.compile(r"<p>(<img [^>]*>)</p>(?:\s*<p><em>((?:(?!</?em>|</p>).)*)</em></p>)?", re.DOTALL)
_TABLE: Final = re.compile(r"<table>.*?</table>", re.DOTALL)


@dataclass(frozen=True)
class Section:
    """A section of a page.

    Attributes
    ----------
    anchor
        Its address in the page.
    title
        Its heading, HTML.
    body
        What follows it, HTML.
    after
        What follows from the next title of the page on, HTML; belongs to none of its sections.
    folded
        Whether it is closed until somebody opens it.
    """

    anchor: str
    title: str
    body: str
    after: str
    folded: bool

    @property
    def name(self) -> str:
        """The heading without mark-up."""
        return re.sub(r"<[^>]+>", "", self.title)


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
    write_text_atomically(folder / "report.md", without_views(text))
    shown = with_views(_html_of(text), folder, environment)
    lead, sections = _parted(_PICTURE.sub(lambda found: f'src="{_data_uri(folder / found[1])}"', shown.body))
    page = environment.get_template("report.html.j2").render(
        title=content["title"],
        style=(_OWN / "report.css").read_text(encoding="utf-8") + shown.style,
        scripts=((_OWN / "report.js").read_text(encoding="utf-8"), *shown.scripts),
        lead=lead,
        sections=sections,
    )
    write_text_atomically(folder / "report.html", page)
    return folder / "report.html"


def _cell(text: str) -> str:
    """Text made safe for a Markdown table and for HTML."""
    text = re.sub(r"[ \t\r\n]+", " ", text).strip()
    return text.replace("&", "&amp;").replace("<", "&lt;").replace("|", "\\|")


def _data_uri(picture: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")


def _html_of(text: str) -> str:
    """HTML of a page's Markdown."""
    found = markdown.markdown(text, extensions=["tables", "fenced_code", "md_in_html", "sane_lists"])
    found = _FIGURE.sub(_figure, found)
    return _TABLE.sub(_boxed, found)


def _parted(body: str) -> tuple[str, Sequence[Section]]:
    """What stands before the first heading of a page's HTML, and its sections."""
    lead, *parts = _HEADING.split(body)
    taken = set(re.findall(r'\bid="([^"]+)"', body))
    sections: list[Section] = []
    for k, (own, title, below) in enumerate(zip(parts[::3], parts[1::3], parts[2::3], strict=True)):
        anchor = own or _new_anchor(title, taken)
        taken.add(anchor)
        own_part, mark, after = below.partition("<h1>")
        sections.append(Section(anchor, title, own_part, mark + after, k >= _OPEN and title != _ALWAYS_OPEN))
    return lead, sections


def _figure(found: re.Match[str]) -> str:
    caption = f"\n<figcaption>{found[2]}</figcaption>" if found[2] else ""
    return f'<figure class="picture">{found[1]}{caption}</figure>'


def _boxed(found: re.Match[str]) -> str:
    table = re.sub(r"<th(?=[ >])", '<th scope="col"', found[0])
    return f'<div class="table">{table}</div>'


def _new_anchor(title: str, taken: set[str]) -> str:
    """An address made of a heading that no other element has."""
    name = re.sub(r"[^a-z0-9]+", "-", re.sub(r"<[^>]+>|&\w+;", "", title).lower()).strip("-") or "section"
    found, k = name, 2
    while found in taken:
        found, k = f"{name}-{k}", k + 1
    return found
