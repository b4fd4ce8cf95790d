"""Pictures that are drawn only when what they show, or the code that draws them, has changed.

A picture carries its key in its own PNG, so that a copy keeps it and no other file lies beside it.
"""

from __future__ import annotations

import hashlib
import inspect
import struct
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType

from solvers.atomic import write_atomically

_NAME = b"bellowsx key"
# A PNG's signature and its first chunk, IHDR; others may follow directly.
_HEAD = 8 + 25


def key_of(*shown: object, files: Iterable[Path] = (), code: Iterable[ModuleType] = ()) -> str:
    """Key of a picture.

    Parameters
    ----------
    *shown
        What it is drawn from: rows, paths, labels; anything whose ``repr`` shows all of it, so no long arrays.
    files
        Files it is drawn from, known by name, size and time of change; they may be missing.
    code
        Modules that draw it.
    """
    digest = hashlib.sha256()
    for thing in shown:
        digest.update(repr(thing).encode())
    for path in files:
        digest.update(repr((str(path), _stamp(path))).encode())
    for module in code:
        digest.update(inspect.getsource(module).encode())
    return digest.hexdigest()[:24]


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_size, found.st_mtime_ns


def once(path: Path, key: str, draw: Callable[[], str]) -> str:
    """Draw a picture unless it is there with this key.

    Parameters
    ----------
    path
        The PNG.
    key
        From `key_of`.
    draw
        Writes the PNG and returns an empty text, or returns why there is no picture.

    Returns
    -------
    str
        What ``draw`` returned, empty if the picture was there; a picture of another key does not stay without reason.
    """
    chunk = _chunk(key)
    if path.is_file() and path.read_bytes()[_HEAD:].startswith(chunk):
        return ""
    path.unlink(missing_ok=True)
    why = draw()
    if not why:
        png = path.read_bytes()
        write_atomically(path, png[:_HEAD] + chunk + png[_HEAD:])
    return why


def _chunk(key: str) -> bytes:
    """The key as a chunk of text of a PNG."""
    body = b"tEXt" + _NAME + b"\0" + key.encode("ascii")
    return struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
