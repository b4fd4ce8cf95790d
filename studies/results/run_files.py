"""What a run leaves on disk: path.csv, summary.json, states and fields; written whole or not at all."""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from solvers.atomic import write_atomically
from solvers.paths.states import Crossing
from solvers.state import State
from studies.results.csv_files import read_records, write_records

PATH_FILE, SUMMARY_FILE, STATES_FOLDER, FIELDS_FOLDER = "path.csv", "summary.json", "states", "fields"
COLLECTION_FILE = "fields.pvd"


@dataclass(frozen=True)
class PathRow:
    """One converged state, as a row of path.csv.

    NaN (an empty field) marks what was not computed. ``unstable_by_m`` has the unstable modes of m = 0…6 about an
    axisymmetric state, ``0;1;0;0;0;0;0`` for one that bends sideways, at requested pressures on r1 or r2.
    ``tip_force_n`` is the axial force of the actuator on what holds or loads its tip, positive outwards: 0 for a free
    tip, minus the scene's dead force (which is positive when it pulls). ``reaction_n`` is that of the support on the
    actuator, so that ``reaction_n + P A = tip_force_n`` with the inlet's area A. ``control`` says what was held in the
    solve; ``status`` is ``requested`` for states at requested pressures, ``step`` for those between. ``limit_kpa`` is
    the pressure of the limit point that the path has passed before the state, from which a body under pressure snaps.
    ``largest_stretch`` is that of the elastomer at quadrature points, corners where it is singular included.
    ``residual`` is that of the accepted state relative to its load: above 1e-8 where it had stalled
    (`solvers.equilibrium.newton.NewtonSettings`). ``whole_residual`` is that of the whole body in the mirrored state,
    where it was solved on a part. ``tip_error_mm`` is what is to be added to ``tip_mm`` for the error of its mesh, as
    the run itself tells it (`studies.models.errors`).
    """

    pressure_kpa: float
    control: str
    tip_mm: float
    tip_centre_mm: float
    tip_force_n: float
    volume_mm3: float
    energy_mj: float
    reaction_n: float
    min_det_f: float
    min_gap_mm: float
    unstable_modes: float
    unstable_by_m: str
    newton_iterations: int
    wall_s: float
    status: str
    bond_slip_rms_mm: float
    limit_kpa: float = math.nan
    residual: float = math.nan
    largest_stretch: float = math.nan
    whole_residual: float = math.nan
    tip_error_mm: float = math.nan


@dataclass(frozen=True)
class RunSummary:
    """A run in figures, as summary.json.

    Attributes
    ----------
    scene, model, level
        Which scene, which model, which mesh (`studies.planning.levels`: ``r4``, ``n8r2``).
    status, reason, cause
        ``reached`` (all requested pressures) or ``stopped``, and why: in words, and the kind (solvers.errors.Cause).
    crossing
        Where the number of unstable modes changed first: kind, pressure_kpa, within_kpa, volume_mm3, modes_before,
        modes_after, and the parity_class where it was solved on a part; empty if nowhere. The mode is in
        ``critical_mode.npz`` and ``critical_mode.vtu``.
    content_hash
        Hash of the inputs and of the code that computes; a finished run with this hash is not repeated.
    plan
        What was skipped and why, a sentence each.
    dofs, cells, nodes
        Size of the body.
    solved_dofs
        Unknowns that were solved for, fewer where symmetry allows it; 0 in runs before 0.3.
    factorisations, newton_iterations, rejected_steps
        Work.
    silicone_g, ring_g
        Masses from the mesh, g; rings are computed from their section when they are not meshed.
    time_s
        Wall seconds by activity; ``total`` is the whole run (modes.json has those of the counts made after it).
    peak_mb
        Peak resident memory of all ranks together.
    versions, blas, ranks, threads, commit, when
        Provenance.
    """

    scene: str
    model: str
    level: str
    status: str
    reason: str
    content_hash: str
    plan: tuple[str, ...]
    dofs: int
    cells: int
    nodes: int
    factorisations: int
    newton_iterations: int
    rejected_steps: int
    silicone_g: float
    ring_g: float
    time_s: dict[str, float]
    peak_mb: float
    versions: dict[str, str]
    blas: str
    ranks: int
    threads: int
    commit: str
    when: str
    cause: str = ""
    crossing: dict[str, Any] = field(default_factory=dict)
    solved_dofs: int = 0


PATH_COLUMNS = tuple(f.name for f in fields(PathRow))


def write_text_atomically(path: Path, text: str) -> None:
    """As `write_atomically`, for text."""
    write_atomically(path, text.encode("utf-8"))


def write_path(folder: Path, rows: Iterable[PathRow]) -> None:
    """Write path.csv."""
    write_records(folder / PATH_FILE, PathRow, rows, 12)


def read_path(folder: Path) -> list[PathRow]:
    """Read path.csv."""
    rows = read_records(folder / PATH_FILE, PathRow)
    # ``asked`` is the status's name before 0.2
    return [replace(row, status="requested") if row.status == "asked" else row for row in rows]


def write_summary(folder: Path, summary: RunSummary) -> None:
    """Write summary.json."""
    write_text_atomically(folder / SUMMARY_FILE, json.dumps(asdict(summary), indent=1, allow_nan=False) + "\n")


def read_summary(folder: Path) -> RunSummary:
    """Read summary.json."""
    data: dict[str, Any] = json.loads((folder / SUMMARY_FILE).read_text(encoding="utf-8"))
    if "rung" in data:  # the key's name before 0.2
        data["model"] = data.pop("rung")
    return RunSummary(**{**data, "plan": tuple(data["plan"])})


def crossing_facts(crossing: Crossing | None, sense: float, parts: int) -> dict[str, Any]:
    """A crossing for the summary, its load as a pressure, its volume that of so many parts."""
    if crossing is None:
        return {}
    return {
        "kind": str(crossing.kind),
        "pressure_kpa": sense * 1e3 * crossing.pressure_mpa,
        "within_kpa": 1e3 * crossing.within_mpa,
        "volume_mm3": sense * parts * crossing.volume_mm3,
        "modes_before": crossing.modes_before,
        "modes_after": crossing.modes_after,
        **({"parity_class": crossing.of_class} if crossing.of_class else {}),
    }


# --- states and fields --------------------------------------------------------------------------------------


def _load_text(pressure_mpa: float, width: int, decimals: int) -> str:
    """A load in kPa for file names, without its sign: with so many decimals, or more if it has more."""
    load = 1e3 * abs(pressure_mpa)
    text = f"{load:0{width}.{decimals}f}"
    return text if math.isclose(float(text), load, rel_tol=1e-9) else f"{load:.9g}"


def _state_file(folder: Path, pressure_mpa: float) -> Path:
    return folder / STATES_FOLDER / f"p{_load_text(pressure_mpa, 9, 4)}.npz"


def save_state(folder: Path, content_hash: str, state: State, row: PathRow) -> None:
    """Write a state and its row of figures atomically."""
    buffer = io.BytesIO()
    np.savez(buffer, **asdict(state), row=json.dumps(asdict(row)), content_hash=content_hash)
    write_atomically(_state_file(folder, state.load_mpa), buffer.getvalue())


def load_state(folder: Path, content_hash: str, pressure_mpa: float) -> tuple[State, PathRow] | None:
    """A saved state, or None if it is missing, damaged or of another content."""
    try:
        with np.load(_state_file(folder, pressure_mpa), allow_pickle=False) as data:
            if str(data["content_hash"]) != content_hash:
                return None
            state = State(data["displacement_mm"], data["pressure_mpa"], data["bodies_mm"], float(data["load_mpa"]))
            return state, PathRow(**json.loads(str(data["row"])))
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
        return None


def field_file(folder: Path, pressure_mpa: float) -> Path:
    """Where a run's fields at a load are."""
    return folder / FIELDS_FOLDER / f"p{_load_text(pressure_mpa, 6, 3)}.vtu"


def field_files(folder: Path, pressures_kpa: Sequence[float]) -> dict[float, Path]:
    """The field files a run has written, by pressure in kPa."""
    files = {p: field_file(folder, 1e-3 * p) for p in pressures_kpa}
    return {p: f for p, f in files.items() if f.exists()}


def write_collection(folder: Path, pressures_kpa: Sequence[float]) -> None:
    """A ParaView collection over the pressures."""
    entries = "".join(
        f'<DataSet timestep="{p:g}" file="{f.relative_to(folder)}"/>'
        for p, f in field_files(folder, pressures_kpa).items()
    )
    text = f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>'
    write_text_atomically(folder / COLLECTION_FILE, text)
