"""The page of all messages: taken from the code by its syntax, so that none is forgotten."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from solvers.errors import Cause
from studies.results.provenance import ROOT
from studies.site.markdown import cell, table

PACKAGES: Final = ("studies", "meshes", "solvers", "analytical")
# Files whose functions return faults and warnings as lines of text instead of raising them.
_LINES: Final[Mapping[str, str]] = {
    "studies/scene": "Faults of a scene",
    "studies/planning/warnings.py": "Warnings",
}
_LEAST_LENGTH: Final = 25
# What each cause of an end means, and what to try.
CAUSES: Final[Mapping[Cause, tuple[str, str]]] = {
    Cause.REACHED: ("all requested loads were reached", "–"),
    Cause.LIMIT_POINT: (
        "the pressure has a maximum here: a body under a rising pressure snaps to another state",
        '`load.control = "auto"` looks for the farther branch; ask for less pressure',
    ),
    Cause.BIFURCATION: (
        "the state is no longer the only one: another shape branches off, which this model cannot take",
        "full 3D, or `bellowsx study branches`; ask for less pressure",
    ),
    Cause.INVERTED_CELL: (
        "a cell is turned inside out (det F at most 0)",
        "a finer mesh, a larger fillet, smaller loads",
    ),
    Cause.MATERIAL_RANGE: (
        "stretches beyond what the law's form can tell",
        "less load, or a law fitted to larger stretches",
    ),
    Cause.LAW_SOFTENS: (
        "the law itself is no longer stable at this stretch, whatever the mesh",
        "less load, or a law that is stable there: `bellowsx material` shows its range",
    ),
    Cause.LINEAR_SOLVER: (
        "a matrix could not be factorised, or something floats",
        "hold the body; see the reason's numbers",
    ),
    Cause.OUT_OF_MEMORY: (
        "the factors did not fit into memory, nor on disk",
        "a coarser mesh, more ranks, a larger machine",
    ),
    Cause.NO_RESPONSE: (
        "the cavity's volume does not change with the pressure, so no step in volume can be taken",
        '`load.control = "pressure"`, or name the surface that is pressed `cavity`',
    ),
    Cause.STEP_SIZE: (
        "steps became too small without an equilibrium",
        "a finer mesh; look at the last state for contact",
    ),
    Cause.TOO_LARGE: (
        "the cavity has grown beyond `load.largest_volume`",
        "raise that key if such stretches are meant",
    ),
    Cause.CONTACT: (
        "contact could not be kept, or is needed and not modelled there",
        "axisymmetric model, smaller loads",
    ),
}
# What stands for a value that is filled in.
VALUE: Final = "…"


@dataclass(frozen=True)
class Message:
    """A text that may be shown, values left out; the exception that carries it, if any, and where it is made."""

    text: str
    error: str
    file: str


def messages_page() -> str:
    """Markdown of the page."""
    found = list(all_messages())
    parts = [
        "# Messages",
        "Every error and warning that the program's own code can give, taken from the code;"
        f" “{VALUE}” stands for a value that is filled in. A message names the key or file, its value, what is wanted,"
        " and mostly the remedy. Look for one by its words, with the site's search or the browser's.",
        "## Exit codes",
        table(
            ("code", "meaning", "what to do"),
            (
                ("0", "all requested loads reached, tolerance met, a study's bars met", "–"),
                ("1", "an error that nobody expected, with a traceback", "report it, with the scene"),
                ("2", "bad input; nothing was meshed, solved or overwritten", "correct what the message names"),
                (
                    "3",
                    "stopped early, tolerance not met, or a bar of a study not met; what there is is kept",
                    "read `reason` in `summary.json`, or the last lines of the terminal",
                ),
            ),
        ),
        "## Why a path stops",
        table(
            ("`cause` in summary.json", "meaning", "what to try"),
            [(f"`{cause.value}`", *CAUSES[cause]) for cause in Cause],
        ),
    ]
    for place, title in _LINES.items():
        parts += [f"## {title}", _table(m for m in found if not m.error and m.file.startswith(place))]
    for error in sorted({m.error for m in found if m.error}):
        parts += [f"## {error}", _table(m for m in found if m.error == error)]
    return "\n\n".join(parts) + "\n"


def _table(messages: Iterator[Message]) -> str:
    lines = sorted({(cell(m.text.replace("<", "&lt;")), f"`{m.file}`") for m in messages})
    return table(("message", "made in"), lines)


def all_messages() -> Iterator[Message]:
    """Messages of all packages."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            file = path.relative_to(ROOT).as_posix()
            yield from messages_of(path.read_text(encoding="utf-8"), file, any(file.startswith(p) for p in _LINES))


def messages_of(source: str, file: str, lines: bool = False) -> Iterator[Message]:
    """Messages of a file's source; with ``lines`` also texts that its functions return."""
    tree = ast.parse(source)
    raised: dict[int, None] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args:
            error, text = _name(node.exc.func), _text(node.exc.args[0])
            raised |= {id(part): None for part in ast.walk(node)}
            if error.endswith(("Error", "StepFailed")) and len(text) >= _LEAST_LENGTH:
                yield Message(text, error, file)
    if not lines:
        return
    whole: dict[int, None] = {}
    for function in (n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)):
        for statement in function.body:
            for node in ast.walk(statement):
                if id(node) in raised or id(node) in whole or isinstance(node, ast.Expr) and _is_text(node.value):
                    whole |= {id(part): None for part in ast.walk(node)}
                elif _is_text(node) or isinstance(node, ast.BinOp):
                    text = _text(node)
                    whole |= {id(part): None for part in ast.walk(node)} if text else {}
                    if len(text) >= _LEAST_LENGTH and ": " in text:
                        yield Message(text, "", file)


def _name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or isinstance(node, ast.Constant) and isinstance(node.value, str)


def _text(node: ast.AST) -> str:
    """The text of a string, values left out; empty if it is none."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(_text(part) if isinstance(part, ast.Constant) else VALUE for part in node.values)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        left, right = _text(node.left), _text(node.right)
        return (left or VALUE) + (right or VALUE) if left or right else ""
    return ""
