"""3D views in pages: a line of a page's Markdown names a run, and the HTML page has the run's view there.

The line is ``<div class="view3d" data-run="core/heung-t1-ri5/full3d-n8"></div>``, the address relative to the page's
folder. It is not in report.md, and leaves nothing in report.html where the run has no fields.
"""

from __future__ import annotations

import html
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from jinja2 import Environment

from studies.report.numbers import typeset
from studies.report.viewer.fields import read_view
from studies.report.viewer.payload import pack

_OWN: Final = Path(__file__).parent
_PLACE: Final = re.compile(r'^<div class="view3d" data-run="([^"]+)"></div>\n*', re.MULTILINE)
_TEMPLATE: Final = "report/viewer/view3d.html.j2"
# Bytes of all views of a page together; three.js takes 0.6 MB more.
_MOST_BYTES: Final = 2_200_000
# Numbers below the bar of colours.
_NUMBERS: Final = 5


@dataclass(frozen=True)
class WithViews:
    """A page's HTML with its 3D views, and what they need in its head and at its end; empty without views."""

    body: str
    style: str
    scripts: tuple[str, ...]


def without_views(markdown: str) -> str:
    """Markdown of a page without the lines that stand for 3D views."""
    return _PLACE.sub("", markdown)


def with_views(body: str, folder: Path, environment: Environment) -> WithViews:
    """HTML of a page's body with its 3D views.

    Parameters
    ----------
    body
        The HTML, with the lines that stand for views.
    folder
        The page's folder, which the runs are below.
    environment
        Knows the templates.
    """
    left = _MOST_BYTES
    views = 0

    def view(found: re.Match[str]) -> str:
        nonlocal left, views
        shown = read_view(folder / html.unescape(found[1]))
        if shown is None:
            return ""
        payload = pack(shown)
        text = json.dumps(payload, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        if len(text) > left:
            return "<p>The 3D view of this body is left out: the page would become too large.</p>\n"
        left -= len(text)
        views += 1
        return environment.get_template(_TEMPLATE).render(_shown(payload), payload=text) + "\n"

    filled = _PLACE.sub(view, body)
    if not views:
        return WithViews(filled, "", ())
    scripts = tuple(_text(name) for name in ("three.min.js", "surface.js", "view3d.js"))
    return WithViews(filled, _text("view3d.css"), scripts)


def _shown(payload: dict[str, Any]) -> dict[str, Any]:
    """What stands round the view."""
    pressures = [state["kpa"] for state in payload["states"]]
    top = payload["top"]
    return {
        "name": payload["name"],
        "colours": payload["colours"],
        "numbers": [f"{1.0 + (top - 1.0) * k / (_NUMBERS - 1):.2f}" for k in range(_NUMBERS)],
        "low_kpa": pressures[0],
        "high_kpa": pressures[-1],
        "pressures": [(f"{typeset(kpa, 'g')} kPa", kpa) for kpa in pressures],
        "rings": payload["rings"],
    }


def _text(name: str) -> str:
    return (_OWN / name).read_text(encoding="utf-8")
