"""The closed-form study: chains, corrections, inverse, validity, material laws, exact solutions, in one report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from analytical.bellows.chains_by_name import SILICONES
from analytical.bellows.paper import PaperActuator, actuators
from studies import two_routes
from studies.closed_form import materials, tables
from studies.closed_form.effects import EFFECTS, Effect
from studies.closed_form.maps import SiliconeMaps, held_sizes, silicone_maps
from studies.closed_form.plots import draw_chains, draw_maps, draw_stress_curves
from studies.closed_form.rows import actuator_rows
from studies.closed_form.sentences import overall, resting_on_saturation, unfolding, warnings, where_large
from studies.engine import Page, Setting, Solved, Study
from studies.results.rows import Row


def cases(options: Mapping[str, Any]) -> Sequence[PaperActuator]:
    """The four actuators of the paper, with the reference dimensions."""
    return actuators()


def solve(actuator: PaperActuator, at: Setting) -> list[Row]:
    """All numbers of an actuator."""
    return actuator_rows(actuator)


def page(solved: Sequence[Solved[PaperActuator, list[Row]]], at: Setting) -> Page:
    """Sections per actuator, tables over all, maps, material laws and exact solutions."""
    four = [done.case for done in solved]
    rows = [entry for done in solved for entry in done.result]
    pairs = (four[:2], four[2:])
    maps = [silicone_maps(silicone) for silicone in SILICONES]
    routes = two_routes.all_routes()
    draw_stress_curves(at.out / "pictures/stress.png", materials.STRETCHES, materials.curves_kpa())
    content = {
        "summary": tables.summary(rows, four),
        "resting": resting_on_saturation(four),
        "actuators": [_section(at.out, done.case, done.result) for done in solved],
        "conventions": tables.convention_table(four),
        "corrections": tables.correction_table(),
        "effects": [tables.correction_effects(rows, pair) for pair in pairs],
        "inverse": tables.inverse_table(rows),
        "held": tables.held_table(rows),
        "held_sizes": held_sizes(),
        "overall": overall(rows),
        "changes": [tables.change_table(rows, pair) for pair in pairs],
        "maps": [_map(at.out, effect, maps, four) for effect in EFFECTS],
        "constants": materials.constants_table(),
        "other_constants": materials.others_table(),
        "stability": materials.stability_table(),
        "routes": two_routes.table(routes),
        "routes_goal": two_routes.GOAL,
        "routes_apart": [one for one in routes if one.difference > two_routes.GOAL],
        "routes_largest": max(one.difference for one in routes),
    }
    return Page([*rows, *materials.material_rows(), *two_routes.rows(routes)], content)


def _section(out: Path, actuator: PaperActuator, rows: Sequence[Row]) -> dict[str, Any]:
    """What the page shows of an actuator; draws its picture on the way."""
    picture = f"pictures/{actuator.name}.png"
    draw_chains(out / picture, actuator)
    d = actuator.dimensions
    return {
        "name": actuator.name,
        "title": (
            f"t = {d.wall_mm:g} mm, R_i = {d.root_radius_mm:g} mm, R_p = {d.crest_radius_mm:g} mm, "
            f"e = {d.half_pitch_mm:g} mm, n = {d.convolutions}, {SILICONES[actuator.silicone]}"
        ),
        "reading": actuator.printed.reading,
        "chains": tables.chain_table(rows),
        "picture": picture,
        "unfolding": unfolding(actuator),
        "outputs": tables.output_table(rows),
        "warnings": warnings(actuator),
    }


def _map(out: Path, effect: Effect, maps: Sequence[SiliconeMaps], four: Sequence[PaperActuator]) -> dict[str, Any]:
    """What the page shows of an effect; draws its maps on the way."""
    picture = f"pictures/validity-{effect.name}.png"
    draw_maps(out / picture, effect, maps, four)
    return {
        "title": effect.title,
        "words": effect.words,
        "picture": picture,
        "sentences": where_large(effect, four, maps),
    }


STUDY: Final = Study(
    name="closed-form",
    title="Closed form of the bellows actuator: three chains, and where they stop being valid",
    question="What does the closed form give as printed and corrected, and where does it stop being valid?",
    template="closed_form/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
)
