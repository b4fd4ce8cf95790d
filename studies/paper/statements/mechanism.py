"""How an actuator elongates: by unfolding or by bulging, of which the paper says both; its tip; strain and volume."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

from studies.paper.results import CaseResult, Four, PaperResults, is_known
from studies.paper.statements.judges import SLOTS, of_each
from studies.paper.statements.verdicts import FAILS, HOLDS, UNDECIDED, Verdict, above, below, smaller
from studies.report.numbers import MISSING, measured_text, number_text, typeset
from studies.report.tables import Table
from studies.results.rows import Row
from studies.scene.bellows import shape_of

# Ours. Predominant: of the elongation. Negligible: how far the roots are beyond the crests, of the folds' depth.
PREDOMINANT: Final = 0.5
NEGLIGIBLE: Final = 0.1
# Ours: a tip whose middle goes as far as its rim, within this part of the rim's way, does not deform.
FLAT: Final = 0.01

Support = Literal["unfolding", "bulging", "neither alone", "cannot tell"]


# --- unfolding or bulging -------------------------------------------------------------------


def _unfolds(case: CaseResult) -> tuple[Verdict, float, str]:
    """Whether most of the elongation is left if the side walls keep their length."""
    row = case.row("unfolding_share")
    text = f"{100.0 * row.value:.0f} % of the elongation against {100.0 * PREDOMINANT:g} %"
    return above((row.value, row.uncertainty), PREDOMINANT), row.value - PREDOMINANT, text


def beyond_crests(case: CaseResult) -> tuple[float, float]:
    """How far the roots' outside is beyond the crests' at 20 kPa, and the depth of the folds, mm."""
    g = case.scene.geometry
    fold = g.crest_radius_mm - g.root_radius_mm
    return case.row("root_bulge_mm").value - fold, fold


def _hardly_bulges(case: CaseResult) -> tuple[Verdict, float, str]:
    """Whether the roots are not, or hardly, beyond the crests."""
    row, (beyond, fold) = case.row("root_bulge_mm"), beyond_crests(case)
    text = f"roots {typeset(beyond, '+.2f')} mm from the crests' radius against {NEGLIGIBLE * fold:+.2f} mm"
    return below((beyond, row.uncertainty), NEGLIGIBLE * fold), NEGLIGIBLE - beyond / fold, text


def _most_at_the_root(case: CaseResult) -> tuple[Verdict, float, str]:
    """Whether the roots' outside is stretched more than the side walls."""
    root, wall = case.row("root_stretch_outer"), case.row("wall_stretch")
    text = f"stretch {measured_text(root)} against {measured_text(wall)} of the side wall"
    return smaller(wall, root), root.value - wall.value, text


UNFOLDS: Final = of_each(_unfolds)
HARDLY_BULGES: Final = of_each(_hardly_bulges)
MOST_AT_THE_ROOT: Final = of_each(_most_at_the_root)


def supports(four: Four) -> tuple[Support, ...]:
    """Which of the two sentences each actuator's state at 20 kPa supports."""
    parts = (judge(four).parts for judge in (UNFOLDS, HARDLY_BULGES, MOST_AT_THE_ROOT))
    return tuple(_support(*of_one) for of_one in zip(*parts, strict=True))


def _support(unfolds: Verdict, hardly_bulges: Verdict, most_at_root: Verdict) -> Support:
    if UNDECIDED in (unfolds, hardly_bulges):
        return "cannot tell"
    if unfolds == HOLDS and hardly_bulges == HOLDS:
        return "unfolding"
    return "bulging" if hardly_bulges == FAILS and most_at_root == HOLDS else "neither alone"


def contradiction(results: PaperResults, drawn: Sequence[Four]) -> Table:
    """What decides between the two sentences at 20 kPa: the reference by actuator, and which how many sets support."""
    by_set = [supports(four) for four in drawn]
    lines = []
    for k, (slot, case) in enumerate(zip(SLOTS, results.reference.cases, strict=True)):
        counts = [of_four[k] for of_four in by_set]
        found: list[Support] = ["unfolding", "bulging", "neither alone", "cannot tell"]
        in_sets = ", ".join(f"{answer} {counts.count(answer)}" for answer in found if answer in counts)
        lines.append((slot, *_state(case), supports(results.reference)[k], in_sets or MISSING))
    header = (
        "actuator",
        "by unfolding, %",
        "roots beyond the crests, mm",
        "depth of a fold, mm",
        "hoop stretch of the root",
        "stretch of the side wall",
        "largest stretch",
        "reference supports",
        "sets that support",
    )
    return Table(header, tuple(lines), left=(0, 6, 7, 8))


def _state(case: CaseResult) -> tuple[str, ...]:
    if not case.axisymmetric:
        return (MISSING,) * 6
    share, peak = case.row("unfolding_share"), case.row("peak_stretch_away")
    beyond, fold = beyond_crests(case)
    return (
        number_text(100.0 * share.value, ".0f"),
        typeset(beyond, "+.1f"),
        f"{fold:g}",
        measured_text(case.row("root_stretch_outer")),
        measured_text(case.row("wall_stretch")),
        f"{measured_text(peak)}: {peak.source}" if is_known(peak) else MISSING,
    )


# --- the tip; strain and volume -------------------------------------------------------------


def _stays_flat(case: CaseResult) -> tuple[Verdict, float, str]:
    """Whether the middle of the tip goes as far as its rim; the mesh's uncertainty is taken to be that of the rim."""
    middle = case.row("tip_centre_mm")
    rim = case.tip(level=middle.level)
    gap = abs(middle.value - rim.value)
    text = f"{middle.value:.2f} mm in the middle against {rim.value:.2f} mm at the rim"
    return below((gap, rim.uncertainty), FLAT * rim.value), FLAT - gap / rim.value, text


STAYS_FLAT: Final = of_each(_stays_flat)


def tube_stretch(case: CaseResult) -> tuple[float, float]:
    """Stretch of a tube of fixed radius that is as long and elongates as much, and its uncertainty.

    An ideal fibre-reinforced actuator: its cavity grows by the same factor.
    """
    tip, length = case.tip(), shape_of(case.scene).cavity_length_mm
    return 1.0 + tip.value / length, tip.uncertainty / length


def _less_than_tube(case: CaseResult, row: Row, what: str) -> tuple[Verdict, float, str]:
    tube, doubt = tube_stretch(case)
    text = f"{what} {number_text(row.value, '.2f')} against {number_text(tube, '.2f')} of the tube"
    return below((row.value - tube, row.uncertainty + doubt), 0.0), tube / row.value - 1.0, text


STRAINS_LESS: Final = of_each(lambda case: _less_than_tube(case, case.row("peak_stretch_away"), "largest stretch"))
GROWS_LESS: Final = of_each(lambda case: _less_than_tube(case, case.row("cavity_volume_ratio"), "volume times"))
