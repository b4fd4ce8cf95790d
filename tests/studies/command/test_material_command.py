"""``bellowsx material``: list, show, plot and fit."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from studies.__main__ import main
from studies.scene.load import load_scene
from studies.scene.silicones.presets import presets

DRAGON_SKIN_30 = "scenes/materials/dragon-skin-30.csv"


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(main, ["material", *map(str, arguments)])


def test_the_list_names_every_silicone() -> None:
    text = invoke("list").output
    assert all(f"\n{name} " in text for name in presets())
    assert set(json.loads(invoke("list", "--json").output)) == set(presets())


def test_show_prints_moduli_and_stresses_of_a_scene(root: Path) -> None:
    scene = root / "scenes" / "smoke-t2-ri5.toml"
    text = invoke("show", scene).output
    assert "initial shear modulus 75.45 kPa" in text and "equibiaxial" in text
    found = json.loads(invoke("show", scene, "--json").output)
    assert found["initial_youngs_modulus_kpa"] == pytest.approx(3.0 * found["initial_shear_modulus_kpa"])
    assert len(found["nominal_stress_kpa"]["uniaxial"]) == len(found["stretch"])


def test_show_tells_a_silicone_s_source_and_what_others_say() -> None:
    text = invoke("show", "dragon-skin-30").output
    assert "doi 10.1089/soro.2019.0115" in text and "Yeoh 153.6, 1.6 kPa" in text and "breaks at stretch 4.64" in text


def test_an_unknown_silicone_is_refused() -> None:
    done = invoke("show", "dragonskin-30")
    assert done.exit_code == 2 and "did you mean dragon-skin-30?" in done.output


def test_plot_draws_the_law_and_its_data(tmp_path: Path) -> None:
    out = tmp_path / "law.png"
    assert invoke("plot", "dragon-skin-30", "--out", out).exit_code == 0
    assert out.read_bytes()[:4] == b"\x89PNG"


def test_what_fit_prints_is_a_scene_s_material(root: Path, tmp_path: Path) -> None:
    picture = tmp_path / "fit.png"
    done = invoke("fit", root / DRAGON_SKIN_30, "--to-stretch", 4, "--picture", picture)
    assert done.exit_code == 0 and picture.stat().st_size > 10_000
    assert "ogden-1" in done.output and "Only uniaxial data" in done.output
    section = done.output[done.output.index("[material]") : done.output.index("# Only")]
    scene = (root / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
    before, rest = scene.split("[material]")
    path = tmp_path / "own.toml"
    path.write_text(before + section + rest[rest.index("\n[") :], encoding="utf-8")
    assert load_scene(path).material.data_to_stretch == pytest.approx(3.97)


def test_fit_tells_programs_covariance_and_ranges(root: Path) -> None:
    done = invoke("fit", root / DRAGON_SKIN_30, "--law", "yeoh", "--to-stretch", 4, "--stable-to", 6, "--json")
    found = json.loads(done.output)
    assert [one["family"] for one in found] == ["yeoh-3", "yeoh-2"]
    assert found[0]["held"] and min(v for v in found[0]["stable_to"].values() if v) >= 6.0
    assert len(found[0]["covariance"]) == len(found[0]["constants"]) == len(found[0]["names"]) == 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.csv"], "data = 'none.csv': cannot be read"),
        ([DRAGON_SKIN_30, "--law", "hooke"], "material.law = 'hooke': fitted are auto"),
        ([DRAGON_SKIN_30, "--to-stretch", "1.12"], "give at least 3"),
        ([DRAGON_SKIN_30, "--picture", "README.md/a.png"], "README.md/a.png: cannot be written"),
        ([DRAGON_SKIN_30, "--picture", "fit.pdf"], "fit.pdf: a picture is a PNG"),
    ],
)
def test_fit_refuses(root: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str) -> None:
    monkeypatch.chdir(root)
    done = invoke("fit", *arguments)
    assert done.exit_code == 2
    assert message in done.output


def test_json_has_no_number_that_is_none() -> None:
    def forbidden(name: str) -> float:
        raise AssertionError(name)

    found = json.loads(invoke("show", "dragon-skin-30", "--json").output, parse_constant=forbidden)
    assert found["law"]["kappa_over_mu"] is None


def test_a_test_that_was_only_pushed_is_drawn_where_it_is(tmp_path: Path) -> None:
    data = tmp_path / "pushed.csv"
    lines = [f"{s},{50.0 * (s - s**-2)}" for s in (0.95, 0.9, 0.85, 0.8, 0.7, 0.6)]
    data.write_text("stretch,nominal_kpa\n" + "\n".join(lines), encoding="utf-8")
    done = invoke("fit", data, "--picture", tmp_path / "pushed.png", "--json")
    assert done.exit_code == 0 and (tmp_path / "pushed.png").stat().st_size > 10_000
