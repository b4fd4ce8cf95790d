"""Where the peers are: NGSolve and FElupe in .venv-peers, CalculiX from Debian, the reference BLAS beside OpenBLAS.

``python -m studies.peers.environment`` makes .venv-peers from packages/peers.txt and installs what
packages/peers-debian.txt lists, as far as that can be done; the study skips what is missing with a line.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from studies.results.provenance import ROOT

VENV = ROOT / ".venv-peers"
LISTS = ROOT / "packages" / "peers.txt", ROOT / "packages" / "peers-debian.txt"


def peers_python(venv: Path = VENV) -> Path | None:
    """The interpreter of the peers' environment, or None."""
    python = venv / "bin" / "python"
    return python if python.exists() else None


def reference_blas() -> Path | None:
    """Folder of Debian's reference BLAS, or None."""
    found = sorted(Path("/usr/lib").glob("*/blas/libblas.so.3"))
    return found[0].parent if found else None


def missing(peer: str, venv: Path = VENV) -> str:
    """Why a peer cannot run here, or nothing."""
    if peer == "calculix":
        return "" if shutil.which("ccx") else "no ccx: apt-get install calculix-ccx"
    if peer == "dolfinx_tutorial_default_blas":
        return "" if reference_blas() else "no reference BLAS: apt-get install libblas3"
    if peer in ("ngsolve", "felupe"):
        python = peers_python(venv)
        if python is None:
            return f"no {venv.name}: python -m studies.peers.environment"
        done = subprocess.run([python, "-c", f"import {peer}"], capture_output=True, text=True, check=False)
        return done.stderr.strip().splitlines()[-1] if done.returncode else ""
    return ""


def make() -> list[str]:
    """Install what is missing; returns what could not be, a line each."""
    faults = []
    debian = [line.split("#")[0].strip() for line in LISTS[1].read_text(encoding="utf-8").splitlines()]
    wanted = [name for name in debian if name and not _installed(name)]
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    command = ["apt-get", "install", "--yes", "--no-install-recommends", *wanted]
    if wanted and os.geteuid():
        faults.append(f"not root: sudo {' '.join(command)}")
    elif wanted and subprocess.run(command, check=False, env=quiet).returncode:
        faults.append(f"failed: {' '.join(command)}")
    if peers_python() is None:
        subprocess.run([Path(sys.executable).resolve(), "-m", "venv", VENV], check=True)
    pip: list[str | Path] = [VENV / "bin" / "python", "-m", "pip", "--disable-pip-version-check"]
    pip += ["install", "--quiet", "--no-deps"]
    if subprocess.run([*pip, "--requirement", LISTS[0]], check=False).returncode:
        faults.append(f"pip could not install {LISTS[0].name} into {VENV.name}")
    return faults


def _installed(package: str) -> bool:
    command = ["dpkg-query", "--show", "--showformat=${db:Status-Status}", package]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.startswith("installed")


if __name__ == "__main__":
    for fault in make():
        print(fault)
