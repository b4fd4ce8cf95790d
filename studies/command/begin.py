"""``bellowsx new``, ``draw`` and ``open``: a scene to start from, its picture, and what came out of it."""

from __future__ import annotations

import re
import webbrowser
from pathlib import Path
from typing import Any

import click
from mpi4py import MPI

from studies.command.common import SCENE, check_writable, examples, load_scenes, refuse, say
from studies.scene.bellows import BellowsScene
from studies.scene.sections import NAME_PATTERN, Section
from studies.site.scene_keys import choices_of

# What a new scene begins with: the paper's actuator with a 2 mm wall and the least that has to be said.
STARTS: dict[str, dict[str, Any]] = {
    "geometry": {
        "kind": "bellows",
        "root_radius_mm": 5.0,
        "crest_radius_mm": 10.5,
        "wall_mm": 2.0,
        "half_pitch_mm": 5.0,
        "convolutions": 8,
    },
    "material": {"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]},
    "load": {"pressure_kpa": [5.0, 10.0, 15.0, 20.0]},
}
# More than so many folds are not drawn with letters.
MOST_FOLDS = 3
REPORTS = ("report.html", "report.md", "rows.csv")


@click.command(name="new", epilog=examples("bellowsx new my.toml"))
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
def new(file: Path) -> None:
    """Write a scene of a bellows into FILE, every key with its meaning; those that have a default are commented out."""
    if not re.fullmatch(NAME_PATTERN, file.stem):
        refuse(f"{file}: a scene has the name of its file, of letters, digits and . _ - : give another name")
    if MPI.COMM_WORLD.rank:
        return
    if file.exists():
        refuse(f"{file}: is there already: nothing is overwritten; give another name")
    check_writable(file.absolute().parent)
    file.write_text(new_scene(file.stem), encoding="utf-8")
    say(f"{file}: change it, then: bellowsx draw {file}; bellowsx plan {file}; bellowsx solve {file} --out results")


def new_scene(name: str) -> str:
    """Text of a new scene."""
    lines = ["# A bellows actuator; lengths in mm, pressures and moduli in kPa.", f'name = "{name}"']
    for key, field in BellowsScene.model_fields.items():
        section = _section_of(key, field.annotation)
        if section is not None:
            lines += ["", f"[{key}]", *_lines(section, STARTS.get(key, {}))]
    return "\n".join(lines) + "\n"


def _section_of(key: str, annotation: Any) -> type[Section] | None:
    if key == "material":
        from studies.scene.materials import YeohMaterial

        return YeohMaterial
    return annotation if isinstance(annotation, type) and issubclass(annotation, Section) else None


def _lines(section: type[Section], given: dict[str, Any]) -> list[str]:
    """Keys of a section, those that are given first."""
    found = []
    for key in [*given, *(name for name in section.model_fields if name not in given)]:
        field = section.model_fields[key]
        value = given.get(key, field.default)
        if value is None:
            continue
        text, choices = f"{key} = {_toml(value)}", choices_of(field.annotation)
        meaning = (field.description or "") + (f": {' | '.join(choices)}" if len(choices) > 1 else "")
        found.append(f"{'' if key in given else '# '}{text:<{40 if key in given else 38}}# {meaning}")
    return found


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value).replace("'", '"')


@click.command(epilog=examples("bellowsx draw my.toml", "bellowsx draw my.toml --picture section.png"))
@SCENE
@click.option("--picture", type=click.Path(path_type=Path), help="PNG of the half section [NAME-section.png].")
def draw(scene: Path, picture: Path | None) -> None:
    """Draw the half section of the bellows of SCENE with its sizes, and print lengths, volume and masses.

    Nothing is solved.
    """
    from studies.report.pictures.lettered import draw_lettered
    from studies.report.style import figure_file

    ((checked, _),) = load_scenes((scene,))
    if not isinstance(checked, BellowsScene):
        refuse(f"{scene}: draws a bellows; the surfaces of a mesh or solid: bellowsx mesh FILE")
    if MPI.COMM_WORLD.rank:
        return
    file = picture or Path(f"{checked.name}-section.png")
    check_writable(file.absolute().parent)
    with figure_file(file, 8.0, 4.6) as figure:
        draw_lettered(figure.add_subplot(), checked, min(checked.geometry.convolutions, MOST_FOLDS), True)
    for what, value, unit in sizes(checked):
        say(f"{what:<34}{value:10.4g} {unit}")
    say(f"picture: {file}")


def sizes(scene: BellowsScene) -> list[tuple[str, float, str]]:
    """Sizes, volume and masses that follow from a scene at rest."""
    from meshes.solid import FACETS
    from studies.models.build import masses_g
    from studies.results.measures import cavity_volume
    from studies.scene.bellows import shape_of
    from studies.scene.meshes import scene_meridian

    # straight between its corners the cavity's outline is 0.02 % off on this meridian, 1.4 % on the coarsest
    shape, meridian = shape_of(scene), scene_meridian(scene, 8)
    silicone, rings = masses_g(scene, meridian)
    inside = meridian.facets[meridian.facet_tags == FACETS["cavity"]]
    line = meridian.points[[*inside[:, 0], inside[-1, 1]]]
    end = shape.cap_mm if shape.has_cap else 0.0
    return [
        ("outer diameter, without rings", 2.0 * shape.seat_radius_mm, "mm"),
        ("outer diameter, with rings", 2.0 * (shape.seat_radius_mm + scene.rings.height_mm), "mm"),
        ("pitch", 2.0 * shape.half_pitch_mm, "mm"),
        ("length of the cavity", shape.cavity_length_mm, "mm"),
        ("length in all", shape.cavity_length_mm + end, "mm"),
        ("volume of the cavity", 1e-3 * abs(cavity_volume(line)), "cm³"),
        ("mass of the silicone", silicone, "g"),
        ("mass of the rings", rings, "g"),
    ]


@click.command(name="open", epilog=examples("bellowsx open results/my"))
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--print", "printed", is_flag=True, help="Print the paths only.")
def open_(folder: Path, printed: bool) -> None:
    """Open the report in FOLDER in a browser, and print what else there is to look at."""
    found = [folder / name for name in REPORTS if (folder / name).exists()]
    fields = sorted(folder.rglob("fields.pvd"))
    if not found and not fields:
        refuse(f"{folder}: holds no results: bellowsx solve, batch or study writes them")
    if (folder / "rows.csv").exists() and not (folder / "report.html").exists():
        say(f"no report yet: bellowsx report {folder}")
    for path in (*found, *fields):
        say(str(path))
    html = folder / "report.html"
    if html.exists() and not printed and not webbrowser.open(html.absolute().as_uri()):
        say("no browser was found: open the first of these files in one", err=True)
