"""The cases of the paper study: scene files, and variants of them that differ in a few keys."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from analytical.bellows.paper import FAMILIES, PRINTED_PRESSURE_KPA, PaperActuator, actuators
from studies.planning.levels import MERIDIANS, BodyLevel
from studies.results import provenance
from studies.scene.dimension_sets import SETS_FILE, SLOTS, read_sets
from studies.scene.silicones.presets import presets
from studies.scene.text import changed_text

Group = Literal[
    "core",
    "zigzag",
    "control",
    "tets",
    "alternates",
    "beyond",
    "convention",
    "silicone",
    "public",
    "blocked",
    "rings",
    "bond",
    "sets",
    "audit",
]

# Parts that can be run alone.
PARTS: Final[Mapping[str, tuple[Group, ...]]] = {
    "core": ("core", "zigzag", "control"),
    "variants": ("tets", "alternates", "beyond", "convention", "silicone", "public", "blocked", "rings", "bond"),
    "sets": ("sets",),
    "audit": ("audit",),
}

PRESSURES_KPA: Final = (5.0, 10.0, 15.0, 20.0)
HIGHEST_KPA: Final = PRINTED_PRESSURE_KPA
# The paper's four actuators in every set of inferred dimensions, by what the report calls the set.
SETS: Final[Mapping[str, tuple[PaperActuator, ...]]] = {
    f"alternate {family.label}" if family.label else "reference": actuators(family) for family in FAMILIES
}
REFERENCE: Final = SETS["reference"]
REFERENCE_SCENES = tuple(actuator.name for actuator in REFERENCE)
ALTERNATE_SCENES = tuple(a.name for label, of_set in SETS.items() if label != "reference" for a in of_set)
THIN, THICK = REFERENCE_SCENES[:2], REFERENCE_SCENES[2:]

SCENES: Final = provenance.ROOT / "scenes"

# Sets of dimensions drawn over all that is unknown, and the meshes they are solved on: many, and each of them unlikely.
DRAWN: Final = read_sets(SCENES / SETS_FILE)
DRAWN_LEVELS: Final = (1, 2)

BEYOND_KPA = [2.5 * k for k in range(1, 13)]
# To beyond where the folds of a blocked 1 mm actuator touch.
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
    scene
        Name of its scene, and of its folder within the group's.
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
    scene: str
    base: str
    label: str
    changes: Mapping[str, Any] = field(default_factory=dict, hash=False)
    levels: tuple[int, ...] = MERIDIANS
    full3d: bool = False

    @property
    def name(self) -> str:
        """Its folder within the study's."""
        return f"{self.group}/{self.scene}"


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
# The actuator that is solved as a whole body too, beside its own case's on a quarter; the mesh, and the pressures.
CONTROL_BODY, CONTROL_BODY_LEVEL, CONTROL_KPA = THICK[0], BodyLevel(8), [10.0, 20.0]
# The actuator with a second full 3D mesh, what that is, and the meridian its first guesses are taken from.
AUDIT_BODY, AUDIT_BODY_LEVEL = REFERENCE_SCENES[0], BodyLevel(24, 3)


@functools.cache
def cases(*groups: Group) -> tuple[Case, ...]:
    """All cases, or those of some groups; those first that the report is about."""
    found = [*_actuators(), *(case for base in REFERENCE_SCENES for case in _loaded(base)), *_materials(), *_bonds()]
    return tuple(case for case in (*found, *_drawn(), *_audits()) if not groups or case.group in groups)


def _actuators() -> Iterator[Case]:
    """The actuators of every set, those of the reference by every model."""
    for name in REFERENCE_SCENES:
        yield Case("core", name, name, "reference", full3d=True)
    for name in REFERENCE_SCENES:
        no_fields = {"ask.fields": False}
        yield Case("zigzag", f"{name}-zigzag", f"zigzag/{name}", "near the zigzag", no_fields, full3d=True)
    changes = {"mesh.symmetry": "off", "load.pressure_kpa": CONTROL_KPA, "ask.fields": False}
    levels = (CONTROL_BODY_LEVEL.meridian,)
    yield _variant("control", CONTROL_BODY, "whole", "whole body", changes, levels=levels, full3d=True)
    for base in REFERENCE_SCENES:
        in_tets = {"mesh.element": "tet", "ask.fields": False}
        yield _variant("tets", base, "tets", "tetrahedra", in_tets, full3d=True)
    for label, of_set in SETS.items():
        for actuator in of_set if of_set is not REFERENCE else ():
            yield Case("alternates", actuator.name, actuator.name, label)


def _loaded(base: str) -> Iterator[Case]:
    """Beyond the paper's pressures, with the tip blocked, and with other rings."""
    beyond = {"load.pressure_kpa": BEYOND_KPA, "ask.fields": False}
    yield _variant("beyond", base, "to-30", "to 30 kPa", beyond, full3d=True)
    blocked = {"load.tip": "blocked", "ask.quantities": ["tip_force_n"], "load.pressure_kpa": BLOCKED_KPA}
    yield _variant("blocked", base, "blocked", "tip blocked", blocked)
    for suffix, label, changes in RING_VARIANTS:
        yield _variant("rings", base, suffix, label, {"mesh.element": "tet", **changes}, levels=RING_LEVELS)


def _materials() -> Iterator[Case]:
    """The other convention of Ogden's mu, the other silicone, and laws fitted to public tensile tests."""
    for base in THICK:
        yield _variant("convention", base, "mu-alpha", "Ogden as mu/alpha", {"material.convention": "mu/alpha"})
        yield _variant("silicone", base, "in-10", "in Dragon Skin 10", {"material": DRAGON_SKIN_10})
    for base in THIN:
        yield _variant("silicone", base, "in-30", "in Dragon Skin 30", {"material": DRAGON_SKIN_30})
    for actuator in REFERENCE:
        of_data = {"material": dict(presets()[actuator.silicone].material)}
        yield _variant("public", actuator.name, "public", "constants from public data", of_data)


def _bonds() -> Iterator[Case]:
    """Bonds, their edge and the crest's shape."""
    for base in THIN:
        more = MORE_BOND_VARIANTS if base == THIN[0] else ()
        for suffix, label, changes in (*BOND_VARIANTS, *more):
            yield _variant("bond", base, suffix, label, {"load.pressure_kpa": BOND_KPA, **changes})


def _drawn() -> Iterator[Case]:
    """The four actuators of every drawn set; the label is the set's name."""
    for drawn in DRAWN:
        for base, slot, actuator in zip(REFERENCE_SCENES, SLOTS, drawn.actuators, strict=True):
            changes = {**drawn.changes(actuator), "ask.fields": False}
            yield Case("sets", f"{drawn.name}-{slot}", base, drawn.name, changes, DRAWN_LEVELS)


def _audits() -> Iterator[Case]:
    """Finer meshes than the study's, which have to lie within its uncertainties."""
    for name in (*REFERENCE_SCENES, *ALTERNATE_SCENES):
        body = name == AUDIT_BODY
        levels = (AUDIT_BODY_LEVEL.meridian, AUDIT_LEVEL) if body else (AUDIT_LEVEL,)
        yield Case("audit", name, name, "audit", {"ask.fields": False}, levels, full3d=body)


def case_text(case: Case) -> str:
    """The scene file of a case: its base's text, comments kept, with the keys that differ."""
    text = (SCENES / f"{case.base}.toml").read_text(encoding="utf-8")
    if case.scene == case.base and not case.changes:
        return text
    return changed_text(text, case.scene, case.changes)
