"""The package works on a machine without a solver, and its closed form starts without scipy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOLVER = ("dolfinx", "ufl", "petsc4py", "mpi4py", "gmsh", "basix")


def modules(folder: str) -> list[str]:
    """Names of all modules below a folder, packages included."""
    paths = sorted((ROOT / folder).rglob("*.py"))
    return [".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for path in paths]


# The fit and the second route are not what scenes use.
CLOSED_FORM = [name for name in modules("analytical/bellows") if ".fit" not in name and "second_route" not in name]


@pytest.mark.parametrize(
    ("names", "blocked"),
    [
        (modules("analytical"), SOLVER),
        # scipy takes 0.1 s to import, which every scene would pay
        (["analytical", *modules("analytical/laws"), *CLOSED_FORM], (*SOLVER, "scipy")),
    ],
    ids=["everything without a solver", "laws and closed form without scipy"],
)
def test_imports_without(names: list[str], blocked: tuple[str, ...]) -> None:
    code = f"import sys\nsys.modules.update(dict.fromkeys({blocked!r}))\nimport {', '.join(names)}\n"
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
