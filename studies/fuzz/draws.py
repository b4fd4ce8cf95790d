"""What is run: inputs drawn by Hypothesis from a seed, the same ones whenever that seed is asked for again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import tomlkit
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from studies.fuzz import scenes
from studies.fuzz.meshfiles import meshes
from studies.fuzz.mutate import damaged
from studies.fuzz.scenes import Contents, body, spoilt
from studies.results.provenance import ROOT

Command = Literal["solve", "plan", "sweep"]


@dataclass(frozen=True)
class Draw:
    """An input and what it is given to.

    Attributes
    ----------
    name, kind
        Number of the draw, and what it was drawn of, for tables.
    command, model
        Of the command line; empty for no ``--model``.
    text
        The scene's or sweep's file.
    mesh
        The file of a user's mesh beside it; empty without one.
    twin
        Another scene with the same answer, see `studies.fuzz.meshfiles`; empty without one.
    """

    name: str
    kind: str
    command: Command
    text: bytes
    model: str = ""
    mesh: bytes = b""
    twin: bytes = b""


# ---- kinds -------------------------------------------------------------------------------------------------


def written(contents: Contents, name: str = "drawn") -> bytes:
    """A scene's file."""
    return tomlkit.dumps({"name": name, **contents}).encode()


@st.composite
def _of_scene(draw: st.DrawFn, kind: str, strategy: st.SearchStrategy[Contents], models: tuple[str, ...] = ()) -> Draw:
    """A scene, one time in five spoilt, and seldom a model that is forced."""
    contents = draw(strategy)
    if draw(st.integers(1, 5)) == 1:
        contents = draw(spoilt(contents))
    model = draw(st.sampled_from(models)) if models and draw(st.integers(1, 8)) == 1 else ""
    return Draw("", kind, "solve", written(contents), model)


@st.composite
def _of_mesh(draw: st.DrawFn, harm: bool) -> Draw:
    """A user's mesh, whole or damaged."""
    contents, file, twin = draw(meshes())
    if harm:
        return Draw("", "damaged .msh", "solve", written(contents), mesh=draw(damaged(file)))
    return Draw("", "mesh", "solve", written(contents), mesh=file, twin=written(twin))


# Files that are damaged. Large scenes are planned only: what damage does is seen before anything is solved.
SMALL: Final = ("smoke-t2-ri5", "exact/tube", "exact/tube-ogden", "exact/sphere", "exact/ring-2-dead", "exact/cube")


@st.composite
def _of_file(draw: st.DrawFn) -> Draw:
    """A damaged scene of the checkout."""
    small = draw(st.booleans())
    every = sorted((ROOT / "scenes").rglob("*.toml"))
    path = draw(st.sampled_from([ROOT / "scenes" / f"{name}.toml" for name in SMALL] if small else every))
    text = draw(damaged(path.read_bytes()))
    return Draw("", "damaged scene", "solve" if small else "plan", text)


@st.composite
def _of_sweep(draw: st.DrawFn) -> Draw:
    """A sweep over two scenes of two convolutions, damaged."""
    wall = [draw(scenes.size(1.0, 3.0)), draw(scenes.size(0.5, 4.0))]
    combine = draw(st.sampled_from(["product", "zip"]))
    head = f'base = "scenes/smoke-t2-ri5.toml"\ncombine = "{combine}"\n'
    text = f"{head}\n[vary]\ngeometry.wall_mm = {wall}\n\n[ask]\npressure_kpa = [3.0]\ntolerance_percent = 2.0\n"
    return Draw("", "damaged sweep", "sweep", draw(damaged(text.encode())))


_3D: Final = ("axisymmetric", "sector", "full3d", "closed_form")
# What is drawn of, with how many of a hundred.
KINDS: Final[dict[str, tuple[int, Callable[[], st.SearchStrategy[Draw]]]]] = {
    "bellows": (32, lambda: _of_scene("bellows", scenes.bellows(), ("axisymmetric", "closed_form"))),
    "tube": (10, lambda: _of_scene("tube", body("tube"), _3D)),
    "sphere": (9, lambda: _of_scene("sphere", body("sphere"), _3D)),
    "ring": (4, lambda: _of_scene("ring", body("ring"))),
    "block": (4, lambda: _of_scene("block", body("block"))),
    "cylinder": (1, lambda: _of_scene("cylinder", body("cylinder"))),
    "cook": (3, lambda: _of_scene("cook", body("cook"))),
    "ventricle": (4, lambda: _of_scene("ventricle", body("ventricle"))),
    "mesh": (6, lambda: _of_mesh(False)),
    "damaged .msh": (11, lambda: _of_mesh(True)),
    "damaged scene": (13, _of_file),
    "damaged sweep": (3, _of_sweep),
}


_ANY: Final = st.sampled_from([kind for kind, (share, _) in KINDS.items() for _ in range(share)]).flatmap(
    lambda kind: KINDS[kind][1]()
)


def draws(number: int, start: int) -> list[Draw]:
    """So many inputs from a seed; the first of them are those that fewer would be."""
    return [replace(_drawn(start * 1_000_000 + k), name=f"{start}-{k:04d}") for k in range(1, number + 1)]


def _drawn(of: int) -> Draw:
    """The input of a seed of its own: Hypothesis begins with the simplest there is, so it is asked for two."""
    found: list[Draw] = []

    @seed(of)
    @settings(
        max_examples=2, phases=[Phase.generate], database=None, deadline=None, suppress_health_check=list(HealthCheck)
    )
    @given(_ANY)
    def collect(drawn: Draw) -> None:
        found.append(drawn)

    collect()
    return found[-1]
