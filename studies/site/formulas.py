"""Formulas of pages as MathML, which browsers show by themselves: no script, no network."""

from __future__ import annotations

import re

from latex2mathml.converter import convert

_CODE = re.compile(r"(```.*?```|~~~.*?~~~|`[^`\n]+`)", re.DOTALL)
_DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
# A dollar that opens has no space after it, one that closes none before it and no digit after: prices stay prices.
_INLINE = re.compile(r"(?<![\\$\w])\$(?=\S)([^$\n]+(?:\n[^$\n]+)?)(?<=\S)\$(?!\d)")
# What stands for a formula while Markdown is read, which would take MathML at the start of a line for a block.
_TOKEN = re.compile(r"⟦([di]):([0-9a-f]+)⟧")
_BLOCK = re.compile(r"<p>(⟦d:[0-9a-f]+⟧)</p>")


def hidden(text: str) -> str:
    """Markdown with ``$…$`` and ``$$…$$`` outside of code put out of Markdown's sight; `shown` brings them back."""
    parts = _CODE.split(text)
    return "".join(part if k % 2 else _of_prose(part) for k, part in enumerate(parts))


def shown(html: str) -> str:
    """HTML with the formulas that `hidden` put away, as MathML."""
    boxed = _BLOCK.sub(r'<div class="formula">\1</div>', html)
    return _TOKEN.sub(lambda found: _mathml(bytes.fromhex(found[2]).decode(), found[1] == "d"), boxed)


def _of_prose(text: str) -> str:
    text = _DISPLAY.sub(lambda found: f"\n\n{_token('d', found[1])}\n\n", text)
    return _INLINE.sub(lambda found: _token("i", found[1]), text)


def _token(kind: str, latex: str) -> str:
    return f"⟦{kind}:{' '.join(latex.split()).encode().hex()}⟧"


def _mathml(latex: str, display: bool) -> str:
    return convert(latex, display="block" if display else "inline")
