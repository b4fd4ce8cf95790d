"""Set-up: the stack that is chosen, what is said where nothing can be, lists that agree."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
STACKS = ("debian-12", "debian-13", "wheel")


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of what set-up reads, without a .venv."""
    shutil.copytree(ROOT / "packages", tmp_path / "packages")
    return tmp_path


def python(path: Path, version: str = "3.12.1", lacks: str = "nothing") -> Path:
    """A program that answers packages/python.sh as an interpreter would."""
    path.write_text(
        f'#!/bin/sh\n[ "$1" = - ] && echo "{lacks}" || echo "{version}"\n',
        encoding="utf-8",
    )
    path.chmod(0o755)
    return path


def run(checkout: Path, *command: str, **variables: str) -> subprocess.CompletedProcess:
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHON", "STACK")}
    return subprocess.run(
        command, cwd=checkout, env=environment | variables, capture_output=True, text=True, check=False, timeout=60
    )


def pins(stack: str) -> dict[str, str]:
    lines = (ROOT / "packages" / "stacks" / f"{stack}.txt").read_text(encoding="utf-8").splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def test_no_pin_of_a_debian_stack_shadows_the_distribution() -> None:
    own = {"numpy", "scipy", "mpi4py", "petsc4py", "gmsh", "fenics-ufl", "fenics-basix", "fenics-ffcx", "cffi"}
    for stack in ("debian-12", "debian-13"):
        assert not own & pins(stack).keys(), stack
    assert {"numpy", "scipy", "mpi4py", "gmsh", "dolfinx-solver-real"} <= pins("wheel").keys()
    # what newer setuptools has dropped is needed by Debian 12's form compiler alone
    assert pins("debian-12")["setuptools"] == "66.1.1"
    assert "66.1.1" not in (pins("debian-13")["setuptools"], pins("wheel")["setuptools"])


def test_what_every_stack_is_asked_for_is_pinned_in_each() -> None:
    text = (ROOT / "packages" / "requirements.in").read_text(encoding="utf-8")
    asked = {re.split(r"[<>=\[]", line.split("#")[0].strip())[0] for line in text.splitlines()} - {""}
    for stack in STACKS:
        assert asked <= pins(stack).keys(), stack


def test_the_stack_of_a_finished_set_up_is_kept(checkout: Path) -> None:
    (checkout / ".venv").mkdir()
    (checkout / ".venv" / "stack").write_text("wheel\n", encoding="utf-8")
    assert run(checkout, "packages/stack.sh").stdout == "wheel\n"


def test_another_system_takes_the_wheel(checkout: Path) -> None:
    (checkout / "packages" / "system.sh").write_text("#!/bin/sh\necho fedora-42\n", encoding="utf-8")
    assert run(checkout, "packages/stack.sh").stdout == "wheel\n"


def test_an_unknown_stack_and_one_of_another_system_are_refused(checkout: Path) -> None:
    for stack, said in (("debian-11", "no stack 'debian-11'"), ("debian-13", "this is not debian-13 but fedora-42")):
        (checkout / "packages" / "system.sh").write_text("#!/bin/sh\necho fedora-42\n", encoding="utf-8")
        done = run(checkout, "packages/setup.sh", stack, ".venv/stamp")
        assert done.returncode == 1 and said in done.stderr
        assert not (checkout / ".venv").exists()


@pytest.mark.parametrize(
    ("version", "lacks"),
    [("3.11.2", "3.12 or later"), ("3.13.5", "venv with pip"), ("3.13.5", "its headers, Python.h")],
)
def test_a_python_that_will_not_do_is_named_and_nothing_is_made(checkout: Path, version: str, lacks: str) -> None:
    odd = python(checkout / "python", version, lacks)
    done = run(checkout, "packages/setup.sh", "wheel", ".venv/stamp", PYTHON=str(odd))
    assert done.returncode == 1
    assert f"{odd} is Python {version} and lacks: {lacks}" in done.stderr
    assert "make setup STACK=wheel PYTHON=" in done.stderr
    assert not (checkout / ".venv").exists()


def test_a_python_that_will_do_is_found(checkout: Path) -> None:
    assert run(checkout, "packages/python.sh", PYTHON=str(python(checkout / "python"))).stdout == f"{checkout}/python\n"


@pytest.mark.skipif(os.geteuid() != 0 or not shutil.which("setpriv"), reason="gives up root's rights")
def test_without_root_and_without_python_the_way_out_is_told(checkout: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:  # pytest's own folders are closed to others
        Path(folder).chmod(0o755)
        shutil.copytree(checkout / "packages", Path(folder, "packages"))
        check_the_way_out(Path(folder))


def check_the_way_out(checkout: Path) -> None:
    (checkout / "packages" / "system.sh").write_text("#!/bin/sh\necho debian-12\n", encoding="utf-8")
    (checkout / "packages" / "missing.sh").write_text("#!/bin/sh\necho python3-dolfinx-real\n", encoding="utf-8")
    nobody = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")
    path = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", "PYTHON": "/usr/bin/false"}
    assert run(checkout, *nobody, "packages/stack.sh", **path).stdout == "debian-12\n"
    done = run(checkout, *nobody, "packages/setup.sh", "debian-12", ".venv/stamp", **path)
    assert done.returncode == 1
    assert "nothing was installed" in done.stderr and "you are not root" in done.stderr
    assert "apt-get install --yes --no-install-recommends python3-dolfinx-real" in done.stderr
    assert "make setup STACK=wheel" in done.stderr
    assert not (checkout / ".venv").exists()


def test_the_container_recipe_is_what_the_roots_run() -> None:
    recipe = (ROOT / "Containerfile").read_text(encoding="utf-8")
    assert re.findall(r"^FROM (.*)", recipe, re.MULTILINE) == ["debian:13-slim"]
    steps = re.findall(r"^RUN (.*)", recipe, re.MULTILINE)
    assert steps[-2:] == ["make setup", "make check"]
    assert steps[0].endswith("git make ca-certificates")  # packages/in_root.sh adds to this line on the wheel stack
    assert not [line for line in recipe.splitlines() if line.endswith("\\")]  # it reads line by line
    assert "sed -n 's/^RUN //p' Containerfile" in (ROOT / "packages" / "in_root.sh").read_text(encoding="utf-8")
