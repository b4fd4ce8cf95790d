"""Damage to files: scenes, sweeps and meshes with bytes, lines, words or numbers that are not what they were."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final

from hypothesis import strategies as st

NUMBER: Final = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
WORD: Final = re.compile(rb"[A-Za-z_]{3,}")
# What a number may become, beside what is near it.
NUMBERS: Final = (b"0", b"-1", b"1e-12", b"1e12", b"nan", b"inf", b"999999999", b"1e400", b"0.1.2", b"0x1F", b"", b"x")
JUNK: Final = (
    b"\x00",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\r",
    b"\n",
    b'"',
    b"[",
    b"]",
    b"=",
    b"#",
    b"$",
    b" ",
    b"\t",
    b"9",
)
Damage = Callable[[st.DrawFn, bytes], bytes]


def _place(draw: st.DrawFn, count: int) -> int:
    """One of so many places, with the first few as likely as all the others: heads of files decide most."""
    if draw(st.booleans()):
        return draw(st.integers(0, min(count, 40) - 1))
    return draw(st.integers(0, count - 1))


def _lines(draw: st.DrawFn, text: bytes) -> bytes:
    """A line left out, doubled, put elsewhere, or cut short."""
    lines = text.splitlines(keepends=True)
    at, how = _place(draw, len(lines)), draw(st.sampled_from(["out", "twice", "elsewhere", "cut"]))
    line = lines.pop(at)
    if how == "twice":
        lines[at:at] = [line, line]
    elif how == "elsewhere":
        lines.insert(_place(draw, len(lines) + 1), line)
    elif how == "cut":
        lines.insert(at, line[: draw(st.integers(0, len(line)))] + b"\n")
    return b"".join(lines)


def _numbers(draw: st.DrawFn, text: bytes) -> bytes:
    """A number replaced by one near it, by another of the file, or by none at all."""
    found = list(NUMBER.finditer(text))
    one = found[_place(draw, len(found))]
    how = draw(st.sampled_from(["near", "another", "odd", "swapped sign", "scaled"]))
    if how == "near":
        new = b"%d" % (int(float(one[0])) + draw(st.sampled_from([-1, 1])))
    elif how == "another":
        new = found[_place(draw, len(found))][0]
    elif how == "odd":
        new = draw(st.sampled_from(NUMBERS))
    elif how == "swapped sign":
        new = b"-" + one[0].lstrip(b"+-")
    else:
        new = b"%.9g" % (float(one[0]) * draw(st.sampled_from([1e-3, 0.5, 1.001, 2.0, 1e3])))
    return text[: one.start()] + new + text[one.end() :]


def _words(draw: st.DrawFn, text: bytes) -> bytes:
    """A word misspelt, in capitals, or in place of another."""
    found = list(WORD.finditer(text))
    one = found[_place(draw, len(found))]
    other = found[_place(draw, len(found))][0]
    new = draw(st.sampled_from([one[0][:-1], one[0].upper(), one[0] + b"s", other]))
    return text[: one.start()] + new + text[one.end() :]


def _bytes(draw: st.DrawFn, text: bytes) -> bytes:
    """A byte put in, taken out or changed; the file cut off; other line ends."""
    at = draw(st.integers(0, len(text) - 1))
    how = draw(st.sampled_from(["in", "in", "out", "bit", "cut off", "line ends"]))
    if how == "cut off":
        return text[:at]
    if how == "line ends":
        return text.replace(b"\n", b"\r\n")
    new = {"in": draw(st.sampled_from(JUNK)) + text[at : at + 1], "out": b""}.get(how, bytes([text[at] ^ 0x10]))
    return text[:at] + new + text[at + 1 :]


@st.composite
def damaged(draw: st.DrawFn, text: bytes) -> bytes:
    """A file's contents with one to three damages."""
    kinds: list[Damage] = [_lines, _numbers, _numbers, _words, _bytes]
    for _ in range(draw(st.sampled_from([1, 1, 2, 3]))):
        if len(text) > 10 and NUMBER.search(text) and WORD.search(text):
            text = draw(st.sampled_from(kinds))(draw, text)
    return text
