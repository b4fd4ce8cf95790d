"""The sweep study: elongation over root radius, wall and number of convolutions, and where the closed form misleads."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from mpi4py import MPI

from analytical.arrays import FloatArray
from analytical.bellows import paper
from studies.closed_form.chains import SILICONES
from studies.models.farm import OUTCOME_FILE, REFUSED, TABLE_FILE, SweepOutcome, SweepRow, read_table, run_sweep
from studies.progress import Progress
from studies.report.labels import model_label
from studies.report.numbers import MISSING, count, duration, signed, up
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.results.rows import REACHED
from studies.scene.bellows import dimensions_of
from studies.scene.files import load_bellows
from studies.sweep.plots import Kind, MapPanel, draw_design_maps
from studies.sweep.rules import LIMIT_PERCENT, Chain, Point, Rule, across, one_factor, two_factors

TITLE: Final = "Design space of the bellows actuator: elongation, and where the closed form misleads"
SWEEP_FILE: Final = provenance.ROOT / "sweeps" / "heung-map.toml"
_BASE: Final = provenance.ROOT / "scenes" / "heung-t1-ri5.toml"
CHAINS: Final[tuple[Chain, ...]] = ("closed_form", "closed_form_balanced", "closed_form_seat")
ROOT_KEY, WALL_KEY, COUNT_KEY = "geometry.root_radius_mm", "geometry.wall_mm", "geometry.convolutions"
# Convolutions of the maps: the reference actuators'.
MAP_COUNT: Final = paper.REFERENCE_FAMILY.convolutions
_SILICONE_BY_LAW: Final[dict[str, paper.Silicone]] = {"yeoh": "dragon-skin-10", "ogden": "dragon-skin-30"}


def write_sweep_study(out: Path, comm: MPI.Comm) -> SweepOutcome:
    """Run the study's sweep into a folder and write its report; every rank calls.

    Returns
    -------
    SweepOutcome
        How the sweep went; the report is ``report.html``.
    """
    outcome = run_sweep(SWEEP_FILE, out, comm, Progress(comm))
    if comm.rank == 0:
        write_sweep_report(out)
    comm.barrier()
    return outcome


def write_sweep_report(folder: Path) -> Path:
    """Write report.md, report.html and pictures/ from the table in a folder; returns report.html."""
    rows = read_table(folder / TABLE_FILE)
    outcome = json.loads((folder / OUTCOME_FILE).read_text(encoding="utf-8"))
    reached = [row for row in rows if row.status == REACHED]
    mapped = [row for row in reached if row.values[COUNT_KEY] == MAP_COUNT]
    points, others = _points(mapped), _points(row for row in reached if row.values[COUNT_KEY] != MAP_COUNT)
    found = _rules(points)
    dimensions = dimensions_of(load_bellows(_BASE))
    relative = [100.0 * row.uncertainty / abs(row.axisymmetric) for row in reached]
    low = sum(row.closed_form_percent < -LIMIT_PERCENT for row in mapped)
    high = sum(row.closed_form_percent > LIMIT_PERCENT for row in mapped)
    content = {
        "title": TITLE,
        "sizes": f"R<sub>p</sub> = {dimensions.crest_radius_mm:g} mm, e = {dimensions.half_pitch_mm:g} mm",
        "roots": _listed(sorted({row.values[ROOT_KEY] for row in rows})),
        "walls": _listed(sorted({row.values[WALL_KEY] for row in rows})),
        "counts": _listed(sorted({row.values[COUNT_KEY] for row in rows})),
        "pressures": _listed(_pressures(reached)),
        "map_count": MAP_COUNT,
        "limit": f"{LIMIT_PERCENT:g}",
        "states": len(mapped),
        "low": low,
        "high": high,
        "share": f"{100.0 * (low + high) / len(mapped):.0f}",
        "worst": signed(min((row.closed_form_percent for row in mapped), key=lambda value: -abs(value))),
        "trusted": _trusted(mapped),
        "shares": _share_table(mapped),
        "by_state": _state_table(mapped),
        "rules": _rule_table(found, points, others),
        "rule": _rule_words(found[-1], points, others),
        "maps": _maps(folder, rows, mapped),
        "per_convolution": _per_convolution_table(reached),
        "convolution_words": _convolution_words(reached),
        "refusals": _refusal_table(rows),
        "refused": sum(row.status.startswith(REFUSED) for row in rows),
        "unreached": _unreached(rows),
        "uncertainty": f"{up(max(relative), 2)}",
        "typical": f"{np.median(relative):.2f}",
        "levels": _levels(reached),
        "unstable": sum(row.unstable_modes > 0.0 for row in reached),
        "outcome": outcome,
        "wall": duration(outcome["wall_s"]),
        "solved": duration(outcome["solved_s"]),
        "provenance": _provenance(outcome),
    }
    return write_page(folder, "sweep.md.j2", content)


# --- what a row is of -----------------------------------------------------------------------


def _levels(rows: Iterable[SweepRow]) -> str:
    """Finest meshes and how many states each gave."""
    return ", ".join(f"{level} ({number} states)" for level, number in sorted(Counter(r.level for r in rows).items()))


def _silicone(row: SweepRow) -> paper.Silicone:
    return _SILICONE_BY_LAW[row.values["material"]["law"]]


def _pressures(rows: Iterable[SweepRow]) -> list[float]:
    return sorted({row.pressure_kpa for row in rows})


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _is_off(percent: float) -> bool:
    return abs(percent) > LIMIT_PERCENT


def _percent(row: SweepRow, chain: Chain) -> float:
    return float(getattr(row, f"{chain}_percent"))


def _unfolded(row: SweepRow) -> bool:
    return row.pressure_kpa >= row.unfolding_kpa


def _groups(rows: Sequence[SweepRow]) -> list[tuple[str, float, list[SweepRow]]]:
    """Silicone's name, pressure, and the rows of both."""
    return [
        (name, pressure, [row for row in rows if _silicone(row) == silicone and row.pressure_kpa == pressure])
        for silicone, name in SILICONES.items()
        for pressure in _pressures(rows)
    ]


def _points(rows: Iterable[SweepRow]) -> list[Point]:
    crest = dimensions_of(load_bellows(_BASE)).crest_radius_mm
    return [
        Point(
            silicone=_silicone(row),
            convolutions=row.values[COUNT_KEY],
            load=1e-3
            * row.pressure_kpa
            * crest
            / (paper.LAWS[_silicone(row)].initial_shear_modulus_mpa * row.values[WALL_KEY]),
            chains={chain: getattr(row, chain) for chain in CHAINS},
            axisymmetric=row.axisymmetric,
        )
        for row in rows
    ]


# --- tables ---------------------------------------------------------------------------------


def _spread(percents: Sequence[float]) -> str:
    """Median and range of differences, %."""
    return f"{signed(float(np.median(percents)))} ({signed(min(percents))} to {signed(max(percents))})"


def _share(percents: Sequence[float]) -> str:
    return f"{100.0 * float(np.mean([_is_off(p) for p in percents])):.0f}"


def _chain_cells(rows: Sequence[SweepRow]) -> list[str]:
    """Spread and share of each chain; dashes if there are no rows."""
    cells = []
    for chain in CHAINS:
        percents = [_percent(row, chain) for row in rows]
        cells += [_spread(percents), _share(percents)] if percents else [MISSING, MISSING]
    return cells


def _chain_header(*first: str) -> tuple[str, ...]:
    names = [model_label(chain) for chain in CHAINS]
    return (*first, *(text for name in names for text in (f"{name}: median (range), %", f"beyond {LIMIT_PERCENT:g} %")))


def _share_table(rows: Sequence[SweepRow]) -> Table:
    lines = [
        (name, f"{pressure:g}", str(len(some)), *_chain_cells(some)) for name, pressure, some in _groups(rows) if some
    ]
    return Table(_chain_header("silicone", "kPa", "designs"), tuple(lines))


def _state_table(rows: Sequence[SweepRow]) -> Table:
    lines = []
    for name in SILICONES:
        for words, unfolded in (("folded", False), ("fully unfolded", True)):
            some = [row for row in rows if _silicone(row) == name and _unfolded(row) == unfolded]
            lines.append((SILICONES[name], words, str(len(some)), *_chain_cells(some)))
    return Table(_chain_header("silicone", "closed form is", "states"), tuple(lines), left=(0, 1))


def _trusted(rows: Sequence[SweepRow]) -> str:
    """Where the closed form is within the limit: the walls and the roots, in words."""
    near = [row for row in rows if not _is_off(row.closed_form_percent)]
    if not near:
        return "nowhere"
    walls = Counter(row.values[WALL_KEY] for row in near)
    all_of = Counter(row.values[WALL_KEY] for row in rows)
    return " and ".join(
        f"{number} of {all_of[wall]} states with t = {wall:g} mm" for wall, number in sorted(walls.items())
    )


def _rules(points: Sequence[Point]) -> list[Rule]:
    """Nothing done, each chain with its best factor, and the best two factors; the best of all last."""
    ones = [one_factor(chain, points) for chain in CHAINS]
    twos = sorted((two_factors(chain, points) for chain in CHAINS), key=lambda rule: rule.hits(points))
    return [Rule("closed_form", 0.0, 1.0, 1.0), *ones, *twos]


def _rule_table(rules: Sequence[Rule], points: Sequence[Point], others: Sequence[Point]) -> Table:
    lines = []
    for rule in rules:
        as_it_is = rule.above == 1.0 and not rule.split
        elsewhere = rule.hits(points) if as_it_is else across(rule.chain, points, split=rule.split > 0.0)
        percents = rule.percent(points)
        lines.append(
            (
                _formula(rule),
                f"{100.0 * rule.hits(points):.0f}",
                f"{100.0 * elsewhere:.0f}",
                f"{100.0 * rule.hits(others):.0f}" if others else MISSING,
                f"{signed(float(percents.min()))} to {signed(float(percents.max()))}",
            )
        )
    header = (
        "rule",
        f"within {LIMIT_PERCENT:g} %, % of the states",
        "found on the other silicone",
        "other numbers of convolutions",
        "range, %",
    )
    return Table(header, tuple(lines))


def _formula(rule: Rule) -> str:
    name = model_label(rule.chain)
    if rule.split:
        return f"{name} × {rule.above:g}; × {rule.below:g} while P R_p/(μ t) is below {rule.split:g}"
    return f"{name} × {rule.above:g}" if rule.above != 1.0 else f"{name} as it is"


def _rule_words(rule: Rule, points: Sequence[Point], others: Sequence[Point]) -> str:
    elsewhere = f" and {100.0 * rule.hits(others):.0f} % of those with other numbers of convolutions" if others else ""
    percents = np.abs(rule.percent(points))
    return (
        f"Take the {model_label(rule.chain)}, and multiply its elongation by {rule.above:g}, or by {rule.below:g} "
        f"while P R<sub>p</sub>/(μ t) is below {rule.split:g} (μ is the initial shear modulus). That meets the finite "
        f"elements within {LIMIT_PERCENT:g} % at {100.0 * rule.hits(points):.0f} % of the states it was found on"
        f"{elsewhere}; nine in ten states are within {float(np.quantile(percents, 0.9)):.0f} %, the worst is "
        f"{float(percents.max()):.0f} % off."
    )


def _per_convolution_table(rows: Sequence[SweepRow]) -> Table:
    """Elongation per convolution at the highest pressure, mm; a line per design that has all numbers."""
    highest = max(_pressures(rows))
    counts = sorted({row.values[COUNT_KEY] for row in rows})
    found = {
        (_silicone(row), row.values[ROOT_KEY], row.values[WALL_KEY], row.values[COUNT_KEY]): row.axisymmetric
        for row in rows
        if row.pressure_kpa == highest
    }
    lines = []
    for root, wall in sorted({key[1:3] for key in found}):
        values = [found.get((silicone, root, wall, n)) for silicone in SILICONES for n in counts]
        if all(value is not None for value in values):
            per = [value / n for value, n in zip(values, counts * len(SILICONES), strict=True) if value is not None]
            lines.append((f"{root:g}", f"{wall:g}", *(f"{value:.2f}" for value in per)))
    header = ("R_i, mm", "t, mm", *(f"{name}, n = {n}" for name in SILICONES.values() for n in counts))
    return Table(header, tuple(lines), left=())


def _convolution_words(rows: Sequence[SweepRow]) -> str:
    """How far elongation per convolution and the closed form's error depend on the number, a sentence."""
    designs: dict[tuple[Any, ...], dict[int, SweepRow]] = {}
    for row in rows:
        key = (_silicone(row), row.values[ROOT_KEY], row.values[WALL_KEY], row.pressure_kpa)
        designs.setdefault(key, {})[row.values[COUNT_KEY]] = row
    texts = []
    for n in sorted({row.values[COUNT_KEY] for row in rows} - {MAP_COUNT}):
        pairs = [(some[n], some[MAP_COUNT]) for some in designs.values() if n in some and MAP_COUNT in some]
        changes = [100.0 * (a.axisymmetric / n / (b.axisymmetric / MAP_COUNT) - 1.0) for a, b in pairs]
        points = [abs(a.closed_form_percent - b.closed_form_percent) for a, b in pairs]
        texts.append(
            f"n = {n} instead of {MAP_COUNT} changes it by {signed(min(changes))} to {signed(max(changes))} % and the "
            f"closed form's difference by at most {max(points):.1f} points"
        )
    return "; ".join(texts) + "."


def _refusal_table(rows: Sequence[SweepRow]) -> Table:
    """Reasons, and the designs of each: roots and walls."""
    found: dict[str, set[tuple[float, float]]] = {}
    for row in rows:
        if row.status.startswith(REFUSED):
            reason = row.status.removeprefix(REFUSED)
            found.setdefault(reason, set()).add((row.values[ROOT_KEY], row.values[WALL_KEY]))
    lines = [
        ("; ".join(f"{root:g}, {wall:g}" for root, wall in sorted(designs)), reason)
        for reason, designs in sorted(found.items(), key=lambda item: sorted(item[1]))
    ]
    return Table(("R_i, t in mm", "why"), tuple(lines), left=(0, 1))


def _unreached(rows: Sequence[SweepRow]) -> list[str]:
    """Scenes that stopped or failed, a sentence each."""
    found = [row for row in rows if row.status != REACHED and not row.status.startswith(REFUSED)]
    return [f"{row.scene} at {row.pressure_kpa:g} kPa: {row.status}" for row in found]


def _provenance(outcome: dict[str, Any]) -> Table:
    stamps = {
        "commit": outcome["commit"],
        "date": outcome["when"],
        "machine": outcome["machine"],
        "ranks": count(outcome["ranks"]),
        **provenance.versions(),
    }
    return facts_table(stamps)


# --- maps -----------------------------------------------------------------------------------


def _maps(folder: Path, rows: Sequence[SweepRow], mapped: Sequence[SweepRow]) -> dict[str, str]:
    """Draw the maps; their places by what they show."""
    of_map = [row for row in rows if row.values[COUNT_KEY] == MAP_COUNT]
    roots = np.array(sorted({row.values[ROOT_KEY] for row in of_map}))
    walls = np.array(sorted({row.values[WALL_KEY] for row in of_map}))

    def grid(some: Sequence[SweepRow], value: Callable[[SweepRow], float]) -> FloatArray:
        found = np.full((len(walls), len(roots)), np.nan)
        for row in some:
            at = np.searchsorted(walls, row.values[WALL_KEY]), np.searchsorted(roots, row.values[ROOT_KEY])
            found[at] = value(row)
        return found

    def draw(name: str, kind: Kind, value: Callable[[SweepRow], float], label: str) -> str:
        panels = [
            MapPanel(
                title=f"{silicone}, {pressure:g} kPa",
                roots_mm=roots,
                walls_mm=walls,
                values=grid(some, value),
                beyond_unfolding=grid(some, lambda row: row.pressure_kpa - row.unfolding_kpa),
            )
            for silicone, pressure, some in _groups(mapped)
        ]
        width = len(_pressures(mapped))
        lines = [panels[k : k + width] for k in range(0, len(panels), width)]
        picture = f"pictures/{name}.png"
        draw_design_maps(folder / picture, lines, kind, label)
        return picture

    found = {
        "elongation": draw(
            "elongation",
            "elongation",
            lambda row: row.axisymmetric,
            f"elongation at the tip by finite elements, n = {MAP_COUNT}, mm",
        )
    }
    for chain in CHAINS:

        def off(row: SweepRow, chain: Chain = chain) -> float:
            return _percent(row, chain)

        found[chain] = draw(chain.replace("_", "-"), "percent", off, f"{model_label(chain)} less finite elements, %")
    return found
