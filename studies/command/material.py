"""``bellowsx material``: silicones by name, what a law says of three tests, and laws fitted to tensile tests."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import click
from mpi4py import MPI

from studies.command.common import JSON, examples, load_scenes, refuse, say
from studies.report.tables import Table, as_text
from studies.scene.sections import SceneError

# Stretches of the printed stress curves.
STRETCHES = (1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0)
WHAT = click.argument("what", metavar="PRESET|SCENE")
PICTURE = click.option("--picture", type=click.Path(path_type=Path), help="PNG of stress over stretch, and of errors.")


@click.group(
    epilog=examples(
        "bellowsx material list",
        "bellowsx material show ecoflex-00-30",
        "bellowsx material fit tensile.csv --picture fit.png",
    )
)
def material() -> None:
    """Silicones by name, stresses of a law, and laws fitted to tensile tests.

    In a scene: [material] preset = "NAME", or data = "tensile.csv".
    """


@material.command("list")
@JSON
def list_(as_json: bool) -> None:
    """List the silicones that a scene can name."""
    from dataclasses import asdict

    from studies.scene.silicones.presets import in_short, presets

    if as_json:
        say(_json({name: asdict(one) for name, one in presets().items()}))
        return
    lines = [(name, one.material["law"], *in_short(one)) for name, one in presets().items()]
    header = ("preset", "law", "initial shear modulus, kPa", "data to stretch", "breaks at stretch")
    say(as_text(Table(header, tuple(lines), (0, 1))))
    say("Constants, source, and what other sources say: bellowsx material show NAME")


@material.command(epilog=examples("bellowsx material show dragon-skin-30", "bellowsx material show my.toml --json"))
@WHAT
@PICTURE
@JSON
def show(what: str, picture: Path | None, as_json: bool) -> None:
    """Print a law: constants, initial moduli, where it is from, and stresses in three homogeneous tests."""
    import numpy as np

    from analytical.exact.homogeneous import MODES, stress_curves
    from studies.planning.warnings import law_range
    from studies.scene.materials import describe_material, law_of

    _check_picture(picture)
    of, told = _material(what)
    law = law_of(of)
    curves = stress_curves(law, np.array(STRETCHES))
    modulus = 1e3 * law.initial_shear_modulus_mpa
    stresses = {mode: 1e3 * curves.nominal_mpa[mode] for mode in MODES}
    if picture is not None:
        _draw(picture, what, law, of.data_to_stretch)
    if as_json:
        content: dict[str, Any] = {
            "law": of.model_dump(mode="json"),
            "initial_shear_modulus_kpa": modulus,
            "initial_youngs_modulus_kpa": 3.0 * modulus,
            "stretch": list(STRETCHES),
            "nominal_stress_kpa": {mode: values.tolist() for mode, values in stresses.items()},
        }
        say(_json(content))
        return
    say("\n".join(line for line in (describe_material(of), law_range(of), *told) if line))
    say(f"initial shear modulus {modulus:.4g} kPa, initial Young's modulus {3.0 * modulus:.4g} kPa")
    lines = [(f"{stretch:g}", *(f"{stresses[mode][k]:.4g}" for mode in MODES)) for k, stretch in enumerate(STRETCHES)]
    say(as_text(Table(("stretch", *(f"{mode}, nominal kPa" for mode in MODES)), tuple(lines), ())))


@material.command(
    epilog=examples("bellowsx material plot ecoflex-00-30", "bellowsx material plot my.toml --out law.png")
)
@WHAT
@click.option("--out", type=click.Path(path_type=Path), help="PNG to write [PRESET.png].")
def plot(what: str, out: Path | None) -> None:
    """Draw nominal stress over stretch; of a silicone beside what the law was fitted to."""
    _check_picture(out)
    from studies.scene.materials import law_of

    of, _ = _material(what)
    _draw(out or Path(f"{Path(what).stem}.png"), what, law_of(of), of.data_to_stretch)


@material.command(
    epilog=examples(
        "bellowsx material fit tensile.csv",
        "bellowsx material fit tensile.csv --law yeoh --stable-to 5 --picture fit.png",
        "bellowsx material fit uniaxial.csv biaxial.csv --to-stretch 4",
    )
)
@click.argument("data", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--law", default="auto", show_default=True, help="Law or family: yeoh, yeoh-3, ogden-2, gent …; auto: by AICc."
)
@click.option("--to-stretch", type=click.FloatRange(min=1.0, min_open=True), help="Leave out points beyond [all].")
@click.option(
    "--stable-to",
    type=click.FloatRange(min=1.0, max=100.0, min_open=True),
    help="Stretch to which moduli must be positive in all tests [the data's largest].",
)
@PICTURE
@JSON
def fit(
    data: tuple[Path, ...],
    law: str,
    to_stretch: float | None,
    stable_to: float | None,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Fit laws to tensile tests: DATA are CSV files of one silicone.

    Columns: stretch, strain, strain_percent or true_strain; nominal_kpa, nominal_mpa, nominal_psi, or true_…; if wanted
    mode (uniaxial, equibiaxial, pure shear) and weight. Least squares in relative error, with positive moduli.
    """
    from studies.scene.silicones.tensile import fits_of, material_of, read_tests, up_to

    _check_picture(picture)
    try:
        tests = up_to([test for file in data for test in read_tests(file, "data")], to_stretch)
        fits = fits_of(tests, law, stable_to)
    except SceneError as error:
        refuse(str(error))
    best = fits[0]
    if picture is not None:
        from studies.report.pictures.stress_curves import draw_stress_curves

        _written(
            picture,
            lambda: draw_stress_curves(
                picture, {one.family: one.law for one in fits[:4]}, tests, 1.05 * best.data_to_stretch
            ),
        )
    if as_json:
        found = [
            {
                "family": one.family,
                "material": material_of(one),
                "names": list(one.names),
                "constants": one.constants.tolist(),
                "covariance": one.covariance.tolist(),
                "rms_percent": 100.0 * one.rms,
                "worst_percent": 100.0 * one.worst,
                "aicc": one.aicc,
                "points": one.points,
                "stable_to": one.stable_to,
                "held": one.held,
            }
            for one in fits
        ]
        say(_json(found))
        return
    lines = [
        (
            one.family,
            ", ".join(f"{v:.4g} ± {d:.2g}" for v, d in zip(one.constants, one.deviations, strict=True)),
            f"{100.0 * one.rms:.3g}",
            f"{100.0 * one.worst:.3g}",
            f"{one.aicc - best.aicc:.1f}",
            "everywhere" if min(one.stable_to.values()) > 99.0 else f"{min(one.stable_to.values()):.3g}",
        )
        for one in fits
    ]
    header = ("law", "constants, kPa and numbers", "rms error, %", "largest, %", "AICc above best", "stable to stretch")
    say(as_text(Table(header, tuple(lines), (0, 1))))
    say(
        f"{best.points} points to stretch {best.data_to_stretch:.4g}; constants {', '.join(best.names)}. For a scene:\n"
    )
    say("[material]\n" + "\n".join(f"{key} = {json.dumps(value)}" for key, value in material_of(best).items()))
    kinds = list(dict.fromkeys(test.mode for test in tests))
    if len(kinds) == 1:
        say(f"\n# Only {kinds[0]} data: what this law says of other states of stress nobody has measured.")
    if best.held:
        say(
            "# Without the condition of positive moduli the constants would be others: the data are close to softening."
        )


def _material(what: str) -> tuple[Any, list[str]]:
    """The material of a preset or of a scene's file, and what is told of it."""
    from studies.scene.silicones.presets import preset, preset_material, presets

    if what in presets() or not Path(what).exists() and not what.endswith(".toml"):
        try:
            one = preset(what)
        except SceneError as error:
            refuse(str(error))
        told = [f"{one.title}: {one.source}", *(f"elsewhere: {other}" for other in one.others)]
        if one.data:
            told.append(f"fitted to {one.data}")
        return preset_material(one), [*told, f"breaks at stretch {one.stretch_at_break:.3g}"]
    ((scene, _),) = load_scenes((Path(what),))
    return scene.material, []


def _draw(path: Path, what: str, law: Any, to_stretch: float | None) -> None:
    from studies.report.pictures.stress_curves import draw_stress_curves
    from studies.results.provenance import ROOT
    from studies.scene.silicones.presets import presets
    from studies.scene.silicones.tensile import read_tests, up_to

    one = presets().get(what)
    largest = to_stretch or 4.0
    tests = up_to(read_tests(ROOT / one.data), 1.001 * largest) if one is not None and one.data else []
    _written(path, lambda: draw_stress_curves(path, {what: law}, tests, 1.05 * largest))


def _check_picture(path: Path | None) -> None:
    """Refuse a picture that cannot be written before anything is fitted."""
    if path is not None and path.suffix.lower() != ".png":
        refuse(f"{path}: a picture is a PNG: give it a name that ends in .png")


def _written(path: Path, work: Any) -> None:
    if MPI.COMM_WORLD.rank:
        return
    try:
        work()
    except OSError as error:
        refuse(f"{path}: cannot be written ({error.strerror})")
    say(f"picture: {path}", err=True)


def _json(content: Any) -> str:
    """JSON text; what is not finite is null."""

    def told(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: told(inner) for key, inner in value.items()}
        if isinstance(value, list | tuple):
            return [told(inner) for inner in value]
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return json.dumps(told(content), indent=1, allow_nan=False)
