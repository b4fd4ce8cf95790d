"""Who may know whom: the arrows between the four packages, read from the source."""

from __future__ import annotations

import ast
import functools
import graphlib
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("analytical", "meshes", "solvers", "studies")
MOST_FILES, MOST_LINES = 15, 400  # files beside `__init__.py`
FINITE_ELEMENTS = {"dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "slepc4py"}
# What dolfinx and UFL have renamed, moved, or made another kind of attribute since 0.5.
RENAMED = {
    "FunctionSpace",
    "VectorFunctionSpace",
    "TensorFunctionSpace",
    "functionspace",
    "FiniteElement",
    "MixedElement",
}
RENAMED |= {"VectorElement", "TensorElement", "cellname", "num_vertices", "ScatterMode"}
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def imports(path: Path) -> set[str]:
    """Full names of everything a file imports anywhere, ``from a import b`` as ``a.b``; relative ones resolved."""
    found = set()
    here = path.relative_to(ROOT).with_suffix("").parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(here[: len(here) - node.level]) if node.level else ""
            module = ".".join(part for part in (base, node.module) if part)
            found |= {f"{module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            assert node.args and isinstance(node.args[0], ast.Constant), f"{path}: import of a computed name"
            found.add(str(node.args[0].value))
    return found


def tops(names: set[str]) -> set[str]:
    return {name.split(".")[0] for name in names}


def of_package(package: str) -> list[Path]:
    files = [path for path in MODULES if path.relative_to(ROOT).parts[0] == package]
    assert files, package
    return files


def label(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", of_package("analytical"), ids=label)
def test_analytical_needs_numpy_and_scipy_only(path: Path) -> None:
    allowed = {"numpy", "scipy", "analytical"} | set(sys.stdlib_module_names)
    assert tops(imports(path)) <= allowed


@pytest.mark.parametrize("path", of_package("analytical"), ids=label)
def test_rooms_of_analytical_know_the_laws_and_not_each_other(path: Path) -> None:
    room = path.relative_to(ROOT).parts[1]
    used = {name.split(".")[1] for name in imports(path) if name.startswith("analytical.")}
    # what a test measures is a homogeneous state's exact stress
    assert used <= {"arrays", "laws", room, *(("exact",) if room == "tensile" else ())}


@pytest.mark.parametrize("path", of_package("meshes"), ids=label)
def test_meshes_know_shapes_and_never_physics(path: Path) -> None:
    used = tops(imports(path))
    assert not used & (set(PACKAGES) - {"meshes"})
    assert not used & FINITE_ELEMENTS


@pytest.mark.parametrize("path", of_package("solvers"), ids=label)
def test_solvers_know_the_material_laws_and_never_a_bellows(path: Path) -> None:
    names = imports(path)
    assert not tops(names) & {"meshes", "studies", "gmsh"}
    foreign = {name for name in names if name.split(".")[0] == "analytical"}
    assert all(name.startswith("analytical.laws.") for name in foreign), foreign


@pytest.mark.parametrize("path", of_package("solvers") + of_package("studies"), ids=label)
def test_versions_of_dolfinx_are_handled_in_one_place(path: Path) -> None:
    if path.parent.name == "compat":
        return
    assert not any(name.startswith(("dolfinx.cpp", "basix", "ffcx")) for name in imports(path))
    used = {
        node.attr for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Attribute)
    }
    assert not used & RENAMED


@pytest.mark.parametrize("package", PACKAGES)
def test_each_package_says_what_it_is(package: str) -> None:
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    assert ast.get_docstring(tree)


@pytest.mark.parametrize("path", MODULES, ids=label)
def test_no_module_names_a_package_registry(path: Path) -> None:
    registries = r"pypi|pythonhosted|anaconda|conda-forge|npmjs|crates\.io|proxy\.golang|deb\.debian|rubygems"
    assert not re.findall(rf"https?://\S*(?:{registries})\S*", path.read_text(encoding="utf-8"))


def test_names_of_test_modules_are_unique() -> None:
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert len(names) == len(set(names))


# ---- circles and sizes -------------------------------------------------------------------------------------


def module_of(path: Path) -> str:
    """Full name of a file's module."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@functools.cache
def graph_of(package: str) -> dict[str, set[str]]:
    """What each module of a package imports of it anywhere: for types only and inside functions too."""
    paths = {module_of(path): path for path in of_package(package)}
    graph = {}
    for module, path in paths.items():
        names = imports(path)
        graph[module] = {name if name in paths else name.rpartition(".")[0] for name in names} & set(paths) - {module}
    return graph


def circle_in(graph: dict[str, set[str]]) -> str:
    """A circle, in words; empty if there is none."""
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return " <- ".join(error.args[1])
    return ""


@pytest.mark.parametrize("package", PACKAGES)
def test_no_import_circle(package: str) -> None:
    assert not circle_in(graph_of(package))


def test_rooms_of_the_solvers_form_no_circle() -> None:
    rooms: dict[str, set[str]] = {}
    for module, known in graph_of("solvers").items():
        room = ".".join(module.split(".")[:2])
        rooms.setdefault(room, set()).update({".".join(name.split(".")[:2]) for name in known} - {room})
    assert not circle_in(rooms)


def test_a_circle_is_found_and_named() -> None:
    assert circle_in({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}).count(" <- ") == 3
    assert circle_in({"a": {"b"}, "b": {"c"}, "d": {"a", "c"}}) == ""


@pytest.mark.parametrize("package", [*PACKAGES, "tests"])
def test_no_folder_has_more_than_fifteen_files_and_no_file_more_than_400_lines(package: str) -> None:
    files = list((ROOT / package).rglob("*.py"))
    for folder in {path.parent for path in files}:
        assert len(list(folder.glob("*.py"))) <= MOST_FILES, label(folder)
    for path in files:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= MOST_LINES, label(path)


# ---- rooms of the studies ----------------------------------------------------------------------------------

# Each knows those before it; then come the engine, folders of studies that know no other, and the commands.
ROOMS = ("scene", "planning", "results", "models", "report")
TOP = ("progress", "first_rank", "mpi_children", "two_routes", "engine")


def room_of(module: str) -> str:
    """First name below ``studies``."""
    return (module.split(".") + [""])[1]


@pytest.mark.parametrize("path", of_package("studies"), ids=label)
def test_rooms_of_the_studies_know_those_before_them(path: Path) -> None:
    room = room_of(module_of(path))
    known = {room_of(name) for name in graph_of("studies")[module_of(path)]} - {"", room}
    if room in ROOMS:
        assert known <= {*ROOMS[: ROOMS.index(room)], "progress", "first_rank"}
    elif room not in ("command", "catalogue", "__main__", *TOP):
        # The study of generated inputs gives them to the command line itself.
        driven = {"__main__"} if room == "fuzz" else set()
        assert known <= {*ROOMS, *TOP, *driven}, "a study that knows another: what they share moves down"
