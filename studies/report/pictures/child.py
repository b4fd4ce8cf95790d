"""Pictures of the body, undeformed and deformed, from its VTU files.

Drawn in a child process: a graphics driver that is missing or ends the process must not take the report
with it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

from studies.report.pictures.half_sections import draw_half_sections
from studies.report.pictures.outside import draw_outside
from studies.report.pictures.stills import RingBox, Still

_SECONDS = 300.0


def draw_states(path: Path, stills: Sequence[Still], stretch_top: float | None = None) -> str:
    """Draw the states below each other to one scale in mm, coloured by the largest principal stretch.

    Each is a half section: outside above the axis, the front lower quarter taken away below it.

    Parameters
    ----------
    path
        The PNG to write.
    stills
        The states, from top to bottom.
    stretch_top
        Stretch at which the colours end; None for the largest of these states.

    Returns
    -------
    str
        Empty, or why there is no picture.
    """
    return _in_child(path, stills, "sections", stretch_top)


def draw_side_by_side(path: Path, stills: Sequence[Still]) -> str:
    """Draw the states from outside, below each other to one scale, as they would lie on a table beside a ruler in cm.

    Coloured by the total displacement in bands of mm, as ANSYS does. The view is oblique; the ruler lies in it along
    the axis, so what it says holds for places on the axis: a line leads to it from where the axis leaves the tip.

    Parameters
    ----------
    path
        The PNG to write.
    stills
        The states, from top to bottom.

    Returns
    -------
    str
        Empty, or why there is no picture.
    """
    return _in_child(path, stills, "outside", None)


def _in_child(path: Path, stills: Sequence[Still], view: str, stretch_top: float | None) -> str:
    """Draw a view of the states in a child process; empty, or why there is no picture."""
    missing = [str(still.vtu) for still in stills if not still.vtu.is_file()]
    if missing:
        return f"no such file: {', '.join(missing)}"
    jobs = [
        [still.label, str(still.vtu.resolve()), still.deformed, [astuple(ring) for ring in still.rings]]
        for still in stills
    ]
    # -c, not -m: finds the package also where the parent found it through sys.path alone.
    code = f"import sys; sys.path[:] = {sys.path!r}; from studies.report.pictures.child import draw_here; draw_here()"
    try:
        child = subprocess.run(
            [sys.executable, "-c", code],
            input=json.dumps({"path": str(path.resolve()), "view": view, "stills": jobs, "stretch_top": stretch_top}),
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"drawing failed: {error}"
    if child.returncode == 0:
        return ""
    said = child.stderr.strip().splitlines()
    return f"drawing failed (exit code {child.returncode}): {said[-1] if said else 'no message'}"


def draw_here() -> None:
    """Draw what standard input asks for; the child's side of `_in_child`."""
    job = json.load(sys.stdin)
    stills = [
        Still(label, Path(vtu), deformed, tuple(RingBox(*ring) for ring in rings))
        for label, vtu, deformed, rings in job["stills"]
    ]
    os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    if job["view"] == "outside":
        draw_outside(Path(job["path"]), stills)
    else:
        draw_half_sections(Path(job["path"]), stills, job["stretch_top"])
