"""Files that are either the old ones or whole new ones."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that whoever reads it, whenever this process dies, finds the old content or the new one.

    Raises
    ------
    OSError
        With the path in its message, also when the disk is full.
    """
    with taking_place_of(path) as temporary, temporary.open("wb") as stream:
        stream.write(content)


@contextmanager
def taking_place_of(path: Path, ending: str = "") -> Iterator[Path]:
    """A file to write beside another one, its name ending as given, that takes its place when all has gone well.

    Raises
    ------
    OSError
        As from `write_atomically`.
    """
    temporary = path.with_name(f"{path.name}.part{ending}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        temporary.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
