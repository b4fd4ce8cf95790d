"""What MkDocs calls while it builds the site: made pages are added, numbers and formulas put into all pages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.utils import get_relative_url

from studies.site.columns import columns_page
from studies.site.formulas import hidden, shown
from studies.site.messages import messages_page
from studies.site.problems import sheets
from studies.site.scene_keys import scene_page
from studies.site.scenes import scenes_page
from studies.site.silicones import silicones_page
from studies.site.values import ValueMissing, filled

# What the theme would fetch for a search in files, and where it is instead.
_FETCHED, _HERE = "https://unpkg.com/iframe-worker/shim", "assets/iframe-worker.js"
# Reports hold numbers of their own, and braces that are none of ours.
_REPORT = "/report.md"


def made_pages() -> Iterator[tuple[str, str]]:
    """Places in the site and Markdown of the pages that are made from the code and from rows."""
    yield "reference/scene.md", scene_page()
    yield "reference/scenes.md", scenes_page()
    yield "reference/rows.md", columns_page()
    yield "reference/messages.md", messages_page()
    yield "reference/silicones.md", silicones_page()
    for name, text in sheets():
        yield f"problems/{name}.md", text


def on_files(files: Files, config: Any) -> Files:
    """Add the made pages."""
    for place, text in made_pages():
        files.append(File.generated(config, place, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Fill in numbers and formulas."""
    if page.file.src_uri.endswith(_REPORT):
        return markdown
    try:
        return hidden(filled(markdown) if "{{" in markdown else markdown)
    except ValueMissing as error:
        raise PluginError(f"{page.file.src_uri}: {error}") from None


def on_page_content(html: str, page: Any, **_: Any) -> str:
    """Show formulas; options of commands that have no default say so."""
    if "{{" in html and not page.file.src_uri.endswith(_REPORT):
        raise PluginError(f"{page.file.src_uri}: a number was not filled in")
    return shown(html).replace("<code>Sentinel.UNSET</code>", "–")


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """Nothing is fetched from elsewhere."""
    return output.replace(_FETCHED, get_relative_url(_HERE, page.url))
