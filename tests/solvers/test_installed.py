"""The stand-in for pkg_resources answers for versions and gives way to the real one for anything else."""

from __future__ import annotations

import importlib.util
import sys
from importlib import metadata

import pytest

from solvers.installed import NAME, _Installed, stand_in

pytestmark = pytest.mark.skipif(importlib.util.find_spec(NAME) is None, reason="no pkg_resources here")


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a new process, also if a test before has wanted the real one."""
    for name in [n for n in sys.modules if n.split(".")[0] == NAME]:
        monkeypatch.delitem(sys.modules, name)
    # what an import in here puts there is taken out again
    monkeypatch.setitem(sys.modules, NAME, None)  # type: ignore[arg-type]
    del sys.modules[NAME]


@pytest.mark.usefixtures("alone")
def test_version_without_looking_through_all_that_is_installed() -> None:
    stand_in()
    import pkg_resources  # type: ignore[import-untyped]

    assert pkg_resources.get_distribution("numpy").version == metadata.version("numpy")
    assert isinstance(sys.modules[NAME], _Installed)


@pytest.mark.usefixtures("alone")
def test_anything_else_is_the_real_one() -> None:
    stand_in()
    from pkg_resources import parse_version

    assert parse_version("1.10") > parse_version("1.9")
    assert not isinstance(sys.modules[NAME], _Installed)
