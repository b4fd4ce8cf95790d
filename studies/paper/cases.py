"""The cases of the paper study: scene files, and variants of them that differ in a few keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from analytical.bellows.paper import ALTERNATE_FAMILIES, REFERENCE_FAMILY, actuators
from studies.planning.levels import MERIDIANS, BodyLevel
from studies.scene.text import changed_text

Group = Literal["core", "tets", "alternates", "beyond", "convention", "silicone", "blocked", "rings", "bond", "audit"]

REFERENCE_SCENES = tuple(actuator.name for actuator in actuators(REFERENCE_FAMILY))
ALTERNATE_SCENES = tuple(actuator.name for family in ALTERNATE_FAMILIES for actuator in actuators(family))
THIN, THICK = REFERENCE_SCENES[:2], REFERENCE_SCENES[2:]

# Half of what full 3D may be uncertain by, so that the axisymmetric model is compared with something better than it.
CORE_TOLERANCE_PERCENT = 0.5
BEYOND_KPA = [2.5 * k for k in range(1, 13)]
# A blocked actuator's folds touch at 3.8 to 12.5 kPa, and contact is not modelled.
BLOCKED_KPA = [1.0, 2.5, 5.0, 7.5, 10.0]
# Rings are compared on equal meshes, so their differences need no extrapolation.
RING_LEVELS = (1, 2)
DRAGON_SKIN_10 = {"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]}
DRAGON_SKIN_30 = {"law": "ogden", "mu_kpa": 75.449, "alpha": 5.836, "convention": "2mu/alpha^2"}


@dataclass(frozen=True)
class Case:
    """One scene of the study.

    Attributes
    ----------
    group
        What it is there for.
    name
        Name of its scene and of its folder within the group's.
    base
        Scene file, without its ending, that it is made from.
    label
        What a table calls it beside the others of its group.
    changes
        Keys that differ from the base, with dots: ``"rings.model": "meshed"``. A whole table replaces the base's.
    levels
        Meridian refinements of its axisymmetric runs.
    full3d
        True if it is solved in full 3D too.
    """

    group: Group
    name: str
    base: str
    label: str
    changes: Mapping[str, Any] = field(default_factory=dict, hash=False)
    levels: tuple[int, ...] = MERIDIANS
    full3d: bool = False

    @property
    def place(self) -> Path:
        """Folder within the study's."""
        return Path(self.group, self.name)


def _variant(group: Group, base: str, suffix: str, label: str, changes: Mapping[str, Any], **more: Any) -> Case:
    return Case(group, f"{base}-{suffix}", base, label, changes, **more)


RING_VARIANTS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("ring-rigid", "rigid", {"rings.model": "rigid"}),
    ("ring-pla", "meshed PLA", {"rings.model": "meshed", "rings.material": "pla"}),
    ("ring-polyethylene", "meshed polyethylene", {"rings.model": "meshed", "rings.material": "polyethylene"}),
)

BOND_KPA = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0]


def _adhesive(normal: float, tangential: float, grading_mm: float) -> dict[str, Any]:
    """Keys of a layer of adhesive, MPa/mm."""
    return {
        "rings.bond": "adhesive",
        "rings.bond_normal_mpa_per_mm": normal,
        "rings.bond_tangential_mpa_per_mm": tangential,
        "rings.bond_grading_mm": grading_mm,
    }


# Variants of the bond, its edge and the crest's shape. Sil-Poxy, 0.3 mm thick, E about 1.7 MPa: 5 and 2 MPa/mm.
BOND_VARIANTS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("bond-rigid", "rigid bond (default)", {}),
    ("bond-300", "layer 300 / 300 MPa/mm", _adhesive(300.0, 300.0, 0.0)),
    ("bond-50-20", "layer 50 / 20 MPa/mm", _adhesive(50.0, 20.0, 0.0)),
    ("bond-5-2", "Sil-Poxy, 5 / 2 MPa/mm", _adhesive(5.0, 2.0, 0.0)),
    ("bond-5-2-graded", "Sil-Poxy, graded over 1 mm", _adhesive(5.0, 2.0, 1.0)),
)
# Tried on one actuator: what a graded edge does by itself, and other shapes of the crest.
MORE_BOND_VARIANTS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("bond-50-20-graded", "layer 50 / 20 MPa/mm, graded over 1 mm", _adhesive(50.0, 20.0, 1.0)),
    ("bond-meshed-pla", "meshed PLA, nodes shared", {"rings.model": "meshed"}),
    ("bond-seat-2", "rigid bond, seat 2 mm", {"rings.seat_mm": 2.0}),
    ("bond-fillet-02", "rigid bond, fillets 0.2 mm", {"geometry.fillet_mm": 0.2}),
    ("bond-fillet-1", "rigid bond, fillets 1 mm", {"geometry.fillet_mm": 1.0}),
)

# Meridian of the audit: finer than all that the study's uncertainties are told from.
AUDIT_LEVEL = 8
# The actuator with a second full 3D mesh, what that is, and the meridian its first guesses are taken from.
AUDIT_BODY, AUDIT_BODY_LEVEL = REFERENCE_SCENES[0], BodyLevel(12, 3)


def audit_cases() -> tuple[Case, ...]:
    """Finer meshes than the study's, which have to lie within its uncertainties."""
    found = []
    for name in (*REFERENCE_SCENES, *ALTERNATE_SCENES):
        body = name == AUDIT_BODY
        levels = (AUDIT_BODY_LEVEL.meridian, AUDIT_LEVEL) if body else (AUDIT_LEVEL,)
        found.append(Case("audit", name, name, "audit", {"ask.fields": False}, levels, full3d=body))
    return tuple(found)


def cases() -> tuple[Case, ...]:
    """All cases, those first that the report is about."""
    exactly = {"ask.tolerance_percent": CORE_TOLERANCE_PERCENT}
    found = [Case("core", name, name, "reference", exactly, full3d=True) for name in REFERENCE_SCENES]
    in_tets = {"mesh.element": "tet", "ask.fields": False}
    found += [_variant("tets", base, "tets", "tetrahedra", in_tets, full3d=True) for base in REFERENCE_SCENES]
    found += [Case("alternates", name, name, f"alternate {name.split('-')[1]}") for name in ALTERNATE_SCENES]
    for base in REFERENCE_SCENES:
        beyond = {"load.pressure_kpa": BEYOND_KPA, "ask.fields": False}
        found.append(_variant("beyond", base, "to-30", "to 30 kPa", beyond, full3d=True))
        blocked = {"load.tip": "blocked", "ask.quantities": ["tip_force_n"], "load.pressure_kpa": BLOCKED_KPA}
        found.append(_variant("blocked", base, "blocked", "tip blocked", blocked))
        found += [
            _variant("rings", base, suffix, label, {"mesh.element": "tet", **changes}, levels=RING_LEVELS)
            for suffix, label, changes in RING_VARIANTS
        ]
    for base in THICK:
        other = {"material.convention": "mu/alpha"}
        found.append(_variant("convention", base, "mu-alpha", "Ogden as mu/alpha", other))
        found.append(_variant("silicone", base, "in-10", "in Dragon Skin 10", {"material": DRAGON_SKIN_10}))
    found += [_variant("silicone", base, "in-30", "in Dragon Skin 30", {"material": DRAGON_SKIN_30}) for base in THIN]
    for base in THIN:
        more = MORE_BOND_VARIANTS if base == THIN[0] else ()
        found += [
            _variant("bond", base, suffix, label, {"load.pressure_kpa": BOND_KPA, **changes})
            for suffix, label, changes in (*BOND_VARIANTS, *more)
        ]
    return tuple(found)


def case_text(case: Case, scenes: Path) -> str:
    """The scene file of a case: its base's text, comments kept, with the keys that differ.

    Parameters
    ----------
    case
        One of `cases`.
    scenes
        Folder of the scene files.
    """
    text = (scenes / f"{case.base}.toml").read_text(encoding="utf-8")
    if case.name == case.base and not case.changes:
        return text
    return changed_text(text, case.name, case.changes)
