"""What this machine runs on, in one block, before a study or a test starts.

Prints the versions that decide a result and its speed, names what is missing with the remedy, and
exits with 1 if the project cannot run. Quick (about a second), so it looks at the big packages that
only draw (vtk, pyvista) without importing them.
"""

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
DEBIAN = "/usr/lib/"  # python3/dist-packages, and petsc/lib/python3/dist-packages for the PETSc builds
TESTED = {"numpy": "1.24", "dolfinx": "0.5", "ufl": "2022.2", "petsc": "3.18", "gmsh": "4.8"}
ANEW = "make distclean setup"
# A shared object that VTK opens at run time, and the Debian package that has it.
DRAWING = {"libEGL.so.1": "libegl1", "libGL.so.1": "libgl1"}

problems: list[str] = []
warnings: list[str] = []


def debian_module(name: str, package: str) -> ModuleType | None:
    """Import a module that must be Debian's own build, since the others were compiled against it."""
    try:
        module = importlib.import_module(name)
    except Exception as error:  # a broken shared library raises more than ImportError
        remedy = f"apt-get install {package}, or make setup"
        if stray := [key for key in ("PYTHONPATH", "PETSC_DIR", "SLEPC_DIR") if os.environ.get(key)]:
            remedy = f"unset {' '.join(stray)}; else {remedy}"
        problems.append(f"{name} does not import ({error}): {remedy}")
        return None
    origin = str(module.__file__)
    if not origin.startswith(DEBIAN):
        problems.append(f"{name} comes from {origin}, not from Debian: {ANEW}, and unset PYTHONPATH")
    return module


def check_pins() -> None:
    """Compare what .venv holds with the pinned list."""
    wrong = []
    for line in (HERE / "requirements.txt").read_text(encoding="utf-8").splitlines():
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
        problems.append(f"Python packages differ from packages/requirements.txt ({'; '.join(wrong)}): {ANEW}")


def blas() -> str:
    """Name the BLAS that this process has really loaded, whatever is installed."""
    loaded = Path("/proc/self/maps").read_text(encoding="utf-8").split()
    try:
        from threadpoolctl import threadpool_info
    except ImportError:
        problems.append(f"threadpoolctl is missing: {ANEW}")
        return "unknown"
    for pool in threadpool_info():
        if pool["user_api"] == "blas":
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
    if sys.prefix == sys.base_prefix:
        problems.append("not run by .venv/bin/python: make check")
    check_pins()

    versions: dict[str, str] = {"python": platform.python_version()}
    for name in ("numpy", "scipy", "mpi4py"):
        if module := debian_module(name, f"python3-{name}"):
            versions[name] = module.__version__
    scalars = ""
    if module := debian_module("petsc4py.PETSc", "python3-petsc4py-real"):
        versions["petsc"] = ".".join(str(part) for part in module.Sys.getVersion())
        real = module.ScalarType().dtype.kind == "f"
        scalars = f"PETSc {'real' if real else 'COMPLEX'}, {module.IntType().dtype}"
        if not real:
            problems.append(
                "PETSc has complex scalars: unset PETSC_DIR, apt-get install python3-dolfinx-real, "
                "and update-alternatives --config petsc"
            )
        if not module.Sys.hasExternalPackage("mumps"):
            problems.append("this PETSc has no MUMPS: apt-get install python3-petsc4py-real")
    for name, package in (("ufl", "dolfinx-real"), ("dolfinx", "dolfinx-real"), ("gmsh", "gmsh")):
        if module := debian_module(name, f"python3-{package}"):
            versions[name] = module.__version__
    for name in ("pyvista", "vtk"):
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            pass  # check_pins has said so

    compiler = (sysconfig.get_config_var("CC") or "gcc").split()[0]
    if not shutil.which(compiler):
        problems.append(f"no C compiler ({compiler}), which dolfinx needs for its forms: apt-get install gcc")
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        problems.append("no Python.h, which dolfinx needs for its forms: apt-get install python3-dev")
    if not shutil.which("mpirun"):
        problems.append("no mpirun: apt-get install openmpi-bin")
    for library, package in DRAWING.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            problems.append(f"no {library}, with which pictures are drawn: apt-get install {package}")
    for name, version in TESTED.items():
        if name in versions and not versions[name].startswith(version + "."):
            warnings.append(f"{name} {versions[name]} is not the {version} this was tested with")

    cores = len(os.sched_getaffinity(0))
    print("  ".join(f"{name} {version}" for name, version in versions.items()))
    print(f"{scalars}  BLAS {blas()}  cores {cores}  memory {memory_gib():.0f} GiB")
    for text in warnings:
        print(f"WARNING: {text}", file=sys.stderr)
    for text in problems:
        print(f"MISSING: {text}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
