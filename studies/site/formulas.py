"""Formulas of pages as MathML, which browsers show by themselves: no script, no network."""

from __future__ import annotations

import re

from latex2mathml.converter import convert

_CODE = re.compile(r"(```.*?```|~~~.*?~~~|`[^`\n]+`)", re.DOTALL)
_DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
# A dollar that opens has no space after it, one that closes none before it and no digit after: prices stay prices.
_INLINE = re.compile(r"(?<![\\$\w])\$(?=\S)([^$\n]+(?:\n[^$\n]+)?)(?<=\S)\$(?!\d)")


def with_mathml(text: str) -> str:
    """Markdown with ``$…$`` and ``$$…$$`` outside of code turned into MathML."""
    parts = _CODE.split(text)
    return "".join(part if k % 2 else _of_prose(part) for k, part in enumerate(parts))


def _of_prose(text: str) -> str:
    text = _DISPLAY.sub(lambda found: f'\n<div class="formula">{_mathml(found[1], "block")}</div>\n', text)
    return _INLINE.sub(lambda found: _mathml(found[1], "inline"), text)


def _mathml(latex: str, display: str) -> str:
    return convert(" ".join(latex.split()), display=display)
