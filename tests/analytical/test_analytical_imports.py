"""The package works on a machine without a solver."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_imports_without_dolfinx() -> None:
    modules = sorted(
        f"analytical.{path.stem}" for path in (ROOT / "analytical").glob("*.py") if path.stem != "__init__"
    )
    code = (
        "import sys\n"
        "for blocked in ('dolfinx', 'ufl', 'petsc4py', 'mpi4py', 'gmsh', 'basix'):\n"
        "    sys.modules[blocked] = None\n"
        f"import analytical, {', '.join(modules)}\n"
    )
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
