"""Scene files of the paper's actuators with the dimensions that the fit inferred, and what can be built of a fit."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Final

import numpy as np

from analytical.arrays import BoolArray
from analytical.bellows.fit.masses import Fittings
from analytical.bellows.fit.members import Members
from analytical.bellows.paper import InferredFamily, PaperActuator, actuators
from analytical.laws.isotropic import Ogden, Yeoh
from meshes.bellows import check_shape
from meshes.errors import GeometryError
from studies.results.run_files import write_text_atomically
from studies.scene.bellows import BellowsScene, shape_of

# What every scene here has.
COLLAR_MM, CAP_MM, SEAT_MM, RING_HEIGHT_MM, FILLET_MM = 3.0, 5.0, 4.0, 2.0, 0.5
FITTINGS: Final = Fittings(CAP_MM, COLLAR_MM, SEAT_MM, RING_HEIGHT_MM)
# Column of the comments in a scene file.
_COMMENT = 28

_CHOSEN = f"""\
collar_mm = {COLLAR_MM}
fillet_mm = {FILLET_MM}
tip = "cap"                 # cap | rigid (a plate)
cap_mm = {CAP_MM}

[rings]
model = "auto"              # auto: rigid unless the tolerance needs them meshed | rigid | meshed | none
material = "pla"            # pla | polyethylene (for their mass, and when meshed)
seat_mm = {SEAT_MM}
bond = "rigid"              # rigid | adhesive: a layer, see bond_normal_mpa_per_mm in studies/scene/bellows.py
height_mm = {RING_HEIGHT_MM}
edge_radius_mm = 0.5
"""

_REQUESTED = """\
[mesh]
element = "auto"            # hex | tet (as in the paper) | auto: hex unless the rings are meshed

[load]
pressure_kpa = [5.0, 10.0, 15.0, 20.0]
control = "auto"            # auto | pressure | volume

[ask]
quantities = ["tip_mm"]
tolerance_percent = 1.0
fields = true
"""


def scene_text(actuator: PaperActuator, label: str) -> str:
    """The scene file of an actuator; comments say what is printed, inferred and chosen.

    Parameters
    ----------
    actuator
        One of a family.
    label
        The family's; empty for the reference.
    """
    d, larger = actuator.dimensions, actuator.printed.has_larger_root
    which = "the larger R_i" if larger else f"R_i = {d.root_radius_mm:g} mm"
    printed, inferred = ("t", "root_radius_mm, ") if larger else ("t, R_i", "")
    alternate = (
        f"# Alternate set {label}: it meets the paper's closed-form numbers, as the reference and many others do.\n"
        if label
        else ""
    )
    lines = (
        ("root_radius_mm", d.root_radius_mm, f"R_i, cavity side ({'inferred' if larger else 'printed'})"),
        ("crest_radius_mm", d.crest_radius_mm, "R_p, cavity side (inferred)"),
        ("wall_mm", d.wall_mm, "t, normal to the wall (printed)"),
        ("half_pitch_mm", d.half_pitch_mm, "e (inferred)"),
        ("convolutions", d.convolutions, "n (inferred)"),
    )
    return (
        f"# Heung et al. 2024, actuator with a {d.wall_mm:g} mm wall and {which}. The paper prints {printed} and the\n"
        f"# material constants; {inferred}crest_radius_mm, half_pitch_mm, convolutions and which silicone are\n"
        "# inferred, the rest is chosen.\n"
        f"{alternate}"
        f'name = "{actuator.name}"\n\n[geometry]\nkind = "bellows"\nprofile = "arcs"\n'
        + "".join(_line(f"{key} = {_number(value)}", comment) for key, value, comment in lines)
        + f"{_CHOSEN}\n{_material(actuator)}\n{_REQUESTED}"
    )


def scene_of(actuator: PaperActuator) -> BellowsScene:
    """The scene of an actuator, checked for its keys but not for its shape."""
    return BellowsScene.model_validate(tomllib.loads(scene_text(actuator, "")))


def write_scenes(folder: Path, families: tuple[InferredFamily, ...]) -> tuple[Path, ...]:
    """Write the scene files of all actuators of families; returns their paths."""
    written = []
    for family in families:
        for actuator in actuators(family):
            path = folder / f"{actuator.name}.toml"
            write_text_atomically(path, scene_text(actuator, family.label))
            written.append(path)
    return tuple(written)


def buildable(members: Members) -> BoolArray:
    """Whether all four actuators have an outline: seat, arcs and side fit into the half pitch and the fold; (m,).

    A set that is refused here is refused for the seat and the fillet that are chosen, not by the paper.
    """
    return np.array([_has_outline(members.family(i)) for i in range(len(members))], dtype=bool)


def _has_outline(family: InferredFamily) -> bool:
    try:
        for actuator in actuators(family):
            check_shape(shape_of(scene_of(actuator)))
    except GeometryError:
        return False
    return True


def _material(actuator: PaperActuator) -> str:
    law = actuator.law
    name = actuator.silicone.replace("dragon-skin-", "Dragon Skin ")
    head = _line("[material]", f"{name} (inferred for this actuator; constants printed)")
    if isinstance(law, Yeoh):
        constants = ", ".join(_number(1e3 * c) for c in law.c_mpa)
        modulus = f"initial shear modulus 2 C1 = {2e3 * law.c_mpa[0]:g} kPa"
        return f'{head}law = "yeoh"\n{_line(f"c_kpa = [{constants}]", modulus)}kappa_over_mu = inf\n'
    assert isinstance(law, Ogden)
    convention = _line(f'convention = "{law.convention}"', "equation (3) of the paper: mu is the initial shear modulus")
    constants = f"mu_kpa = {_number(1e3 * law.mu_mpa)}\nalpha = {_number(law.alpha)}\n"
    return f'{head}law = "ogden"\n{constants}{convention}kappa_over_mu = inf\n'


def _line(text: str, comment: str) -> str:
    return f"{text:<{_COMMENT}}# {comment}\n"


def _number(value: float | int) -> str:
    """As TOML, with the decimals of a drawing: 10.5, and 5.0 for a whole length."""
    return str(value) if isinstance(value, int) else repr(round(value, 9))
