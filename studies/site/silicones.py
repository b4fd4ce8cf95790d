"""The page of the silicones that a scene can name."""

from __future__ import annotations

from studies.scene.materials import describe_material
from studies.scene.silicones.presets import Preset, in_short, preset_material, presets
from studies.site.markdown import cell, table

HEADER = ("`material.preset`", "initial shear modulus, kPa", "data to stretch", "breaks at stretch")


def silicones_page() -> str:
    """Markdown of the page."""
    parts = [
        "# Silicones by name",
        'What `[material] preset = "NAME"` stands for (`bellowsx material list`): law, constants, source, and what'
        " other sources say of the same silicone. Those with data are fitted to one specimen of a public database,"
        " whose strain is the machine's crosshead's: the laws are on the soft side, as makers' moduli beside them"
        " show. For a design that has to hold, [test your own](../tutorials/own-silicone.md).",
        table(HEADER, map(_line, presets().values())),
    ]
    for one in presets().values():
        parts += [f"## {one.title} {{#{one.name}}}", _about(one)]
    return "\n\n".join(parts) + "\n"


def _line(one: Preset) -> tuple[str, ...]:
    return f"[`{one.name}`](#{one.name})", *in_short(one)


def _about(one: Preset) -> str:
    lines = [f"`{one.name}`: {cell(describe_material(preset_material(one)))}.", f"*Source.* {cell(one.source)}."]
    if one.data:
        lines.append(f"*Data.* `{one.data}`.")
    lines += [f"*Elsewhere.* {cell(other)}" for other in one.others]
    return "\n\n".join(lines)
