"""Compare two rows.csv, or two folders of them, to the last digit: ``python tests/compare_rows.py BEFORE AFTER``.

Rows are matched by all their columns but value, uncertainty, reference, source, error and status, and by their order
where those are the same. Times, memory and speeds are left out: they are never the same. Errors in percent may differ
by round-off of the numbers they are made of. The exit code is 1 if a row is in one only or a number differs by more
than ``--relative`` (default: not at all).
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import click

KEYS = ("scene", "quantity", "unit", "pressure_kpa", "model", "level")
NUMBERS = ("value", "uncertainty", "reference", "error_percent")
# Names of columns and of quantities before 0.2.
RENAMED = {"rung": "model", "mend_effect_cm": "correction_effect_cm"}
NEVER_THE_SAME = ("s", "MB", "1/s", "ms", "us", "us/cell")

# Nine digits of a value and of its reference, percent.
ROUND_OFF_PERCENT = 2e-7

Key = tuple[str, ...]


def read(path: Path) -> dict[Key, dict[str, str]]:
    """Rows of a file by key; repeated keys are counted."""
    found: dict[Key, dict[str, str]] = {}
    with path.open(newline="", encoding="utf-8") as stream:
        for line in csv.DictReader(stream):
            named = {RENAMED.get(name, name): RENAMED.get(text, text) for name, text in line.items()}
            if named["unit"] in NEVER_THE_SAME:
                continue
            key = tuple(named[name] for name in KEYS)
            place = 0
            while (*key, str(place)) in found:
                place += 1
            found[(*key, str(place))] = named
    return found


def apart(one: str, other: str) -> float:
    """Relative difference of two numbers as text; infinite if one of them is none."""
    if one == other:
        return 0.0
    if not one or not other:
        return math.inf
    a, b = float(one), float(other)
    return abs(a - b) / max(abs(a), abs(b), 1e-300)


def round_off(one: str, other: str) -> bool:
    """True if two errors in percent are the same but for round-off."""
    return abs(float(one) - float(other)) <= ROUND_OFF_PERCENT


def differences(before: Path, after: Path) -> Iterator[tuple[float, str]]:
    """What differs between two files: by how much (infinite for a row in one only), and in words."""
    old, new = read(before), read(after)
    for key in [k for k in old if k not in new]:
        yield math.inf, f"only before: {', '.join(key)}"
    for key in [k for k in new if k not in old]:
        yield math.inf, f"only after: {', '.join(key)}"
    for key in [k for k in old if k in new]:
        for name in NUMBERS:
            gap = apart(old[key][name], new[key][name])
            if gap and not (name == "error_percent" and gap < math.inf and round_off(old[key][name], new[key][name])):
                yield gap, f"{', '.join(key)}: {name} {old[key][name]} -> {new[key][name]}"


def pairs(before: Path, after: Path) -> list[tuple[Path, Path]]:
    """Files to compare; of folders, those of the same relative path."""
    if before.is_file():
        return [(before, after)]
    return [(path, after / path.relative_to(before)) for path in sorted(before.rglob("rows.csv"))]


@click.command()
@click.argument("before", type=click.Path(path_type=Path, exists=True))
@click.argument("after", type=click.Path(path_type=Path, exists=True))
@click.option("--relative", default=0.0, show_default=True, help="Largest relative difference that is none.")
@click.option("--show", default=10, show_default=True, help="So many of the largest differences of a file.")
def main(before: Path, after: Path, relative: float, show: int) -> None:
    """Compare rows.csv of BEFORE and AFTER, files or folders."""
    failed = False
    for old, new in pairs(before, after):
        if not new.exists():
            click.echo(f"{new}: missing")
            failed = True
            continue
        found = sorted(differences(old, new), reverse=True)
        beyond = [entry for entry in found if entry[0] > relative]
        failed = failed or bool(beyond)
        largest = f", largest relative difference {found[0][0]:.2g}" if found else ", all equal"
        click.echo(f"{old}: {len(read(old))} rows, {len(beyond)} differ{largest}")
        for _, text in beyond[:show]:
            click.echo(f"  {text}")
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
