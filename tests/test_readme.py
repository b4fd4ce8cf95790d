"""Numbers of the README are those of the rows of the kept reports."""

from __future__ import annotations

import csv
import math
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
NAMES = {
    "t = 1 mm, R_i = 5 mm, Dragon Skin 10": "heung-t1-ri5",
    "t = 1 mm, R_i = 7 mm, Dragon Skin 10": "heung-t1-ri7",
    "t = 2 mm, R_i = 5 mm, Dragon Skin 30": "heung-t2-ri5",
    "t = 2 mm, R_i = 7 mm, Dragon Skin 30": "heung-t2-ri7",
}
PRESSURES = ("5", "10", "15", "20")
AUDIT_LEVELS = ("r3", "r8", "n12r3", "n24r3")


@cache
def rows(study: str) -> tuple[dict[str, str], ...]:
    with (ROOT / "docs" / study / "rows.csv").open(encoding="utf-8", newline="") as file:
        return tuple(csv.DictReader(file))


def found(study: str, scene: str, quantity: str, model: str, pressure: str = "20") -> dict[str, str]:
    """The last row, which is that of the finest mesh; of the paper study, of that which is not for its audit only."""
    alike = [
        row
        for row in rows(study)
        if (row["scene"], row["quantity"], row["model"], row["pressure_kpa"]) == (scene, quantity, model, pressure)
        and not (study == "paper" and row["level"] in AUDIT_LEVELS)
    ]
    assert alike, (study, scene, quantity, model, pressure)
    return alike[-1]


def tip(scene: str, model: str, pressure: str = "20") -> float:
    return float(found("paper", scene, "tip_mm", model, pressure)["value"])


def text(scene: str, model: str) -> str:
    """As the table has it: uncertainties rounded up."""
    row = found("paper", scene, "tip_mm", model)
    doubt = f" ± {math.ceil(100.0 * float(row['uncertainty']) - 1e-9) / 100.0:.2f}" if row["uncertainty"] else ""
    return f"{float(row['value']):.2f}{doubt}"


def percent(scene: str, pressure: str, outline: str = "") -> float:
    """Closed form less full 3D, of the latter."""
    elements = tip(scene + outline, "full3d", pressure)
    return 100.0 * (tip(scene, "closed_form", pressure) / elements - 1.0)


@pytest.mark.parametrize("called", NAMES)
def test_main_table(called: str) -> None:
    name = NAMES[called]
    cells = [text(name, "closed_form"), text(f"{name}-zigzag", "full3d"), text(name, "full3d")]
    cells += [f"{tip(name, f'paper_{what}'):g}" for what in ("closed_form", "ansys", "experiment")]
    assert f"| {called} | {' | '.join(cells)} |" in README


def test_outline_or_model() -> None:
    thin, thick = list(NAMES.values())[:2], list(NAMES.values())[2:]
    later = max(abs(percent(name, p, "-zigzag")) for name in thick for p in PRESSURES[1:])
    assert f"within {math.ceil(10.0 * later) / 10.0:g} % from 10 kPa on" in README
    early = max(abs(percent(name, p, "-zigzag")) for name in thin for p in PRESSURES[:2])
    assert f"within {math.ceil(10.0 * early) / 10.0:g} % to 10 kPa" in README
    beyond = [-percent(name, p, "-zigzag") for name in thin for p in PRESSURES[2:]]
    assert f"({min(beyond):.0f} to {max(beyond):.0f} % low)" in README
    moulded = [-percent(name, p) for name in NAMES.values() for p in PRESSURES]
    assert f"falls {min(moulded):.0f} to {max(moulded):.0f} % short" in README


def test_all_states_are_stable_and_a_core_off_the_axis_bends() -> None:
    counts = {
        float(found("paper", f"{name}{outline}", "unstable_modes", model, p)["value"])
        for name in NAMES.values()
        for outline in ("", "-zigzag")
        for model in ("axisymmetric", "full3d")
        for p in PRESSURES
    }
    assert counts == {0.0}
    bend = abs(float(found("imperfection", "heung-t2-ri5-e10", "tip_bend_deg", "full3d", "5")["value"]))
    assert f"by {bend:.1f} degrees already at 5 kPa" in README


def test_uncertainties_and_sets() -> None:
    report = (ROOT / "docs" / "paper" / "report.md").read_text(encoding="utf-8")
    (held,) = re.findall(r"\d+ of \d+(?= axisymmetric uncertainties)", README)
    assert re.search(rf"axisymmetric uncertainties that hold the limit: all meshes.*\({held}\)", report)
    (solid,) = re.findall(r"all (\d+) in full 3D", README)
    whole = "full 3D uncertainties that hold the limit: all meshes, all cases: at least 95 %"
    assert f"{whole} | 100.0 % ({solid} of {solid})" in report
    (spread,) = re.findall(r"at 20 kPa is (\S+ to \S+ %) from", README)
    assert f"chosen dimensions: {spread} from the reference's" in report


def test_stress() -> None:
    report = (ROOT / "docs" / "stability" / "report.md").read_text(encoding="utf-8")
    said = r"(\d+) runs along .* end in (\d+) answers right within 1 %, (\d+) inputs rejected, (\d+) runs stopped with"
    (counts,) = re.findall(said, README)
    assert f"| all |  | {' | '.join(counts)} | 0 |" in report


TO_FASTEST = "time_ratio_full3d_to_fastest_peer"


def test_cost() -> None:
    def seconds(model: str, level: str) -> float:
        (row,) = (
            row
            for row in rows("cost")
            if (row["scene"], row["quantity"], row["model"], row["level"]) == ("peer-bellows", "wall_s", model, level)
        )
        return float(row["value"])

    def ratio(quantity: str) -> float:
        return float(
            found("cost", "peer-bellows", f"time_ratio_full3d_at_equal_error{quantity}", "full3d", "10")["value"]
        )

    warm, cold = (min(seconds("full3d", f"hex n8 {way} {on}") for on in ("1x2", "2x1")) for way in ("warm", "cold"))
    assert f"takes {warm:.1f} s to an answer" in README and f"and {cold:.1f} s if it starts from zero" in README
    assert f"takes {seconds('peer_dolfinx_tutorial', 'hex27-n8r1 steps=5'):.1f} s." in README
    (off,) = (
        abs(float(row["error_percent"]))
        for row in rows("cost")
        if (row["scene"], row["quantity"], row["level"]) == ("peer-bellows", "tip_mm", "hex n8 warm 2x1")
        and row["model"] == "full3d"
    )
    assert f"to an answer {off:.2g} % off" in README
    quarters = {
        row["level"]: float(row["value"])
        for row in rows("peers")
        if row["quantity"] == "wall_s" and row["model"] == "peer_ngsolve" and "-quarter" in row["level"]
    }
    level = min(quarters, key=lambda one: quarters[one])
    (theirs,) = (
        abs(float(row["error_percent"]))
        for row in rows("peers")
        if (row["quantity"], row["model"], row["level"]) == ("tip_mm", "peer_ngsolve", level)
    )
    cut = float(found("peers", "peer-bellows", f"{TO_FASTEST}_with_quarters", "full3d", "10")["value"])
    equal = ratio("_with_quarters")
    assert f"({quarters[level]:.1f} s, {theirs:.1g} % off) it takes {cut:.2f} of the time to 1 %" in README
    assert f"and {equal:.2f} of it at equal error" in README
    flat = [
        float(found("peers", "peer-bellows", f"time_ratio_axisymmetric_{kind}", "axisymmetric", "10")["value"])
        for kind in ("to_fastest_peer", "at_equal_error")
    ]
    assert f"takes {flat[0]:.1f} times as long as a script of one mesh to 1 %, {flat[1]:.1f} times as long at" in README
    assert f"takes {ratio(''):.2f} of" in README and f"and {ratio('_by_lasting_error'):.2f} if" in README


def test_it_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


def test_links_lead_somewhere() -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", README)
    assert [link for link in links if not (ROOT / link).exists()] == []
