"""A quick answer to one question, of what version a package is, in place of ``pkg_resources``.

UFL and FFCx of Debian 12 import ``pkg_resources`` to ask it for their own versions, and it looks through all that is
installed first, which takes as long as to import PETSc. Whoever wants anything else of it gets the real one.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from importlib import metadata
from types import ModuleType
from typing import Any

NAME = "pkg_resources"


class _Installed(ModuleType):
    """``pkg_resources`` until more than a version is asked of it."""

    def get_distribution(self, name: str) -> metadata.Distribution:
        """Something with the attribute ``version``."""
        return metadata.distribution(name)

    def __getattr__(self, name: str) -> Any:
        if sys.modules.get(NAME) is self:
            del sys.modules[NAME]
        return getattr(importlib.import_module("pkg_resources"), name)


def stand_in() -> None:
    """Put it in place, unless the real one has been imported or is not there."""
    if NAME not in sys.modules and (spec := importlib.util.find_spec(NAME)) is not None:
        sys.modules[NAME] = _Installed(NAME)
        sys.modules[NAME].__spec__ = spec
