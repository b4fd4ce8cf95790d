"""The study in miniature: two convolutions by every model; its page is that of all reports of bellows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from studies.engine import Page, Setting, Solved, Study
from studies.models.session import run_plan
from studies.planning.bellows import plan_bellows
from studies.report.scene_page import report_of
from studies.report.scene_report import SceneReport
from studies.report.scenes import content, verdict
from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import quarters

SCENE: Final = provenance.ROOT / "scenes" / "smoke-t2-ri5.toml"
# Cells round the whole body.
FEWEST: Final = (6,)


def cases(options: Mapping[str, Any]) -> list[BellowsScene]:
    """The one scene."""
    return [load_bellows(SCENE)]


def solve(scene: BellowsScene, at: Setting) -> SceneReport:
    """Every model, on the fewest cells round."""
    text, place = SCENE.read_text(encoding="utf-8"), at.out / scene.name
    for plan in (plan_bellows(scene, "sector", (quarters(scene),)), plan_bellows(scene, "full3d", FEWEST)):
        run_plan(scene, text, plan, place, at.comm, at.progress)
    return report_of(place)


def page(solved: Sequence[Solved[BellowsScene, SceneReport]], at: Setting) -> Page:
    """What the models say of each bellows."""
    reports = [done.result for done in solved]
    rows = [row for report in reports for row in report.rows]
    return Page(
        rows,
        content(at.out, reports),
        stopped=[f"{report.name}: {report.stopped}" for report in reports if report.stopped],
        headlines=[f"{report.name}: {verdict(report)}" for report in reports],
    )


STUDY: Final = Study(
    name="smoke",
    title="Two convolutions by every model",
    question="Does all work, from the closed form to full 3D, in a minute?",
    template="smoke/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
)
