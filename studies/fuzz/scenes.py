"""Strategies for scenes of every kind, as the contents of their files: mostly buildable, at times extreme or absurd.

Sizes are such that an axisymmetric run takes about a second. Loads are drawn beside a rough strength of the body, so
that some are easily carried, some are at its limit and some beyond.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

Contents = dict[str, Any]
# What no key should hold, and what some may.
ABSURD: Sequence[Any] = (
    *(0, -1, 1, 0.0, -0.0, 1e-300, 1e-9, 1e9, 1e308, -3.7, math.inf, -math.inf, math.nan, 10**30),
    *(True, "", "a", "inf", "1.0", [], [[]], {}, [0.0], [1.0, 1.0], [3.0, -2.0], [math.nan], ["a"], {"a": 1}),
)


def size(low: float, high: float) -> st.SearchStrategy[float]:
    """A number of three digits, as likely in one decade as in another."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: float(f"{10.0**power:.3g}"))


def seldom(odd: st.SearchStrategy[Any], usual: Any, one_in: int = 6) -> st.SearchStrategy[Any]:
    """A usual value, and one time in so many another one."""
    return st.integers(1, one_in).flatmap(lambda k: odd if k == one_in else st.just(usual))


def loads(strength: float, least: float = 0.02, most: float = 2.0) -> st.SearchStrategy[list[float]]:
    """One to three ascending loads by a body's rough strength; one time in ten far too small or too large."""
    highest = seldom(size(1e-6, 1e4), None, 10).flatmap(lambda odd: size(least, most) if odd is None else st.just(odd))
    shares = st.sampled_from([(1.0,), (0.5, 1.0), (0.1, 0.9, 1.0)])
    return st.tuples(highest, shares).map(lambda drawn: [float(f"{strength * drawn[0] * s:.4g}") for s in drawn[1]])


def laws(guccione: bool = False) -> st.SearchStrategy[Contents]:
    """Materials of every law."""
    modulus = seldom(size(1e-2, 1e5), None, 12).flatmap(lambda odd: size(5.0, 800.0) if odd is None else st.just(odd))
    kappa = seldom(size(10.1, 1e9), math.inf, 3)
    yeoh = st.tuples(size(3.0, 300.0), st.floats(-0.05, 0.3), st.floats(0.0, 0.05), st.integers(1, 3)).map(
        lambda c: {"law": "yeoh", "c_kpa": [float(f"{x:.4g}") for x in (c[0], c[0] * c[1], c[0] * c[2])[: c[3]]]}
    )
    alpha = st.one_of(size(1.3, 9.0), size(1.3, 9.0), st.sampled_from([2.0, 4.0, -2.0, -4.5, 0.5, 20.0, 0.0]))
    convention = st.sampled_from(["2mu/alpha^2", "mu/alpha"])
    ogden = st.fixed_dictionaries(
        {"law": st.just("ogden"), "mu_kpa": modulus, "alpha": alpha, "convention": convention}
    )
    neo_hooke = st.fixed_dictionaries({"law": st.just("neo-hooke"), "mu_kpa": modulus})
    series = st.tuples(size(5.0, 300.0), st.floats(-0.2, 0.5), size(1.3, 6.0), st.sampled_from([-2.0, 4.0, 7.5])).map(
        lambda c: {
            **{"law": "ogden", "convention": "2mu/alpha^2", "alpha": [c[2], c[3]]},
            "mu_kpa": [c[0], float(f"{c[0] * c[1]:.4g}")],
        }
    )
    shares = st.tuples(st.floats(-0.3, 1.0), *(st.floats(-0.05, 0.1) for _ in range(3)))
    mooney = st.tuples(size(3.0, 300.0), shares, st.sampled_from([2, 2, 3, 5])).map(
        lambda c: {"law": "mooney-rivlin", "c_kpa": [float(f"{c[0] * x:.4g}") for x in (1.0, *c[1])[: c[2]]]}
    )
    gent = st.fixed_dictionaries({"law": st.just("gent"), "mu_kpa": modulus, "limit": size(1.5, 200.0)})
    chains = st.fixed_dictionaries(
        {"law": st.just("arruda-boyce"), "mu_kpa": modulus, "stretch_limit": size(1.1, 12.0)}
    )
    kinds = [yeoh, ogden, neo_hooke, series, mooney, gent, chains]
    if guccione:
        kinds.append(st.fixed_dictionaries({"law": st.just("guccione"), "c_kpa": modulus, "b": size(0.5, 8.0)}))
    return st.tuples(st.one_of(kinds), kappa).map(lambda drawn: {**drawn[0], "kappa_over_mu": drawn[1]})


def modulus_of(material: Contents) -> float:
    """A material's initial shear modulus, kPa; roughly, and positive."""
    if material["law"] == "yeoh":
        return 2.0 * float(material["c_kpa"][0])
    if material["law"] == "mooney-rivlin":
        return 2.0 * float(sum(material["c_kpa"][:2]))
    if material["law"] == "guccione":
        return 0.5 * float(material["b"] * material["c_kpa"])
    if isinstance(material["mu_kpa"], list):
        return float(sum(material["mu_kpa"]))
    return float(material["mu_kpa"])


def asks(quantities: Sequence[str]) -> st.SearchStrategy[Contents]:
    """What is asked: a tolerance, one or more quantities or the default, seldom fields."""
    tolerance = seldom(size(1e-3, 100.0), None, 5).flatmap(lambda odd: size(0.2, 5.0) if odd is None else st.just(odd))
    wanted = st.lists(st.sampled_from(quantities), min_size=1, max_size=2, unique=True)
    drawn = st.fixed_dictionaries({"tolerance_percent": tolerance, "fields": seldom(st.just(True), False, 12)})
    return st.tuples(drawn, seldom(wanted, None, 3)).map(
        lambda both: both[0] if both[1] is None else {**both[0], "quantities": both[1]}
    )


PROFILES = st.sampled_from(["arcs", "arcs", "zigzag", "polyline"])
CONTROLS = seldom(st.sampled_from(["pressure", "volume", "arc"]), "auto", 3)


# ---- bellows -----------------------------------------------------------------------------------------------


@st.composite
def bellows(draw: st.DrawFn) -> Contents:
    """A bellows of one or two convolutions with any profile, rings, bond, tip and load."""
    wall, root = draw(size(0.4, 2.5)), draw(size(2.0, 9.0))
    profile, model = draw(PROFILES), draw(st.sampled_from(["auto", "rigid", "none", "none", "meshed"]))
    straight = profile == "zigzag"
    fillet = 0.1 if straight else draw(size(0.1, 1.0))
    seat = 0.5 if straight else draw(size(0.5, 4.0))
    # what two bends and a seat need, times a margin that is seldom below one
    beside = 0.0 if model == "none" else 0.5 * seat
    pitch = round((beside + 2.0 * fillet + wall) * draw(size(0.95, 4.0)), 3)
    crest = round(root + (2.0 * fillet + wall) * draw(size(0.95, 5.0)), 3)
    geometry: Contents = {
        "kind": "bellows",
        "profile": profile,
        "root_radius_mm": root,
        "crest_radius_mm": crest,
        "wall_mm": wall,
        "half_pitch_mm": pitch,
        "convolutions": draw(st.sampled_from([1, 1, 2])),
        "collar_mm": round((beside + fillet) * draw(size(0.95, 5.0)), 3),
        "tip": draw(st.sampled_from(["cap", "cap", "rigid"])),
        "cap_mm": draw(size(0.5, 6.0)),
    }
    rings: Contents = {"model": model, "height_mm": draw(size(0.5, 4.0))}
    if not straight or draw(st.integers(1, 10)) == 1:
        geometry["fillet_mm"] = fillet
        rings |= {"seat_mm": seat, "edge_radius_mm": round(0.2 * min(seat, rings["height_mm"]), 3)}
    if profile == "polyline" or draw(st.integers(1, 20)) == 1:
        middle, between = pitch * draw(st.floats(0.4, 0.6)), root + (crest - root) * draw(st.floats(0.3, 0.7))
        geometry["points_mm"] = [[round(middle, 3), round(between + 0.5 * wall, 3)]]
    if draw(st.integers(1, 4)) == 1:
        rings |= {"bond": "adhesive", "bond_normal_mpa_per_mm": draw(size(0.5, 1e3)), "bond_grading_mm": 0.0}
        rings |= {"bond_tangential_mpa_per_mm": draw(size(0.5, 1e3)), "material": "polyethylene"}
    material = draw(laws())
    pressures = draw(loads(modulus_of(material) * wall / crest))
    load: Contents = {"pressure_kpa": pressures, "control": draw(CONTROLS)}
    if draw(st.integers(1, 4)) == 1:
        load["pressure_kpa"] = [-0.2 * p for p in pressures]
    load["tip"] = draw(seldom(st.just("blocked"), "free", 4))
    if geometry["tip"] == "rigid" and draw(st.integers(1, 4)) == 1:
        load["tip_force_n"] = round(1e-3 * pressures[-1] * root**2 * draw(st.floats(-2.0, 3.0)), 4)
    ask = draw(asks(["tip_mm", "tip_force_n"] if load["tip"] == "blocked" else ["tip_mm"]))
    scene = {"geometry": geometry, "rings": rings, "material": material, "load": load, "ask": ask}
    scene["ask"]["modes"] = draw(seldom(st.just(True), False, 4))
    scene["mesh"] = {"element": draw(seldom(st.sampled_from(["hex", "tet", "tet-p0", "tet-p1"]), "auto", 3))}
    scene["contact"] = {"model": draw(seldom(st.just("off"), "auto", 5))}
    return scene


# ---- simple bodies -----------------------------------------------------------------------------------------


def body(kind: str) -> st.SearchStrategy[Contents]:
    """A simple body of a kind."""
    return _bodies(kind)


@st.composite
def _bodies(draw: st.DrawFn, kind: str) -> Contents:
    material = draw(laws(guccione=True))
    mu, inner = modulus_of(material), draw(size(1.0, 20.0))
    ratio = 1.0 + draw(
        seldom(size(1e-3, 1e3), None, 8).flatmap(lambda odd: size(0.05, 2.0) if odd is None else st.just(odd))
    )
    outer = float(f"{inner * ratio:.5g}")
    radii: Contents = {"kind": kind, "inner_radius_mm": inner, "outer_radius_mm": outer}
    load: Contents = {"control": draw(CONTROLS)}
    quantities: Sequence[str]
    if kind in ("tube", "sphere"):
        geometry, quantities = radii, ("bore_mm", "limit_kpa")
        if kind == "tube":
            ends = draw(st.sampled_from(["plane-strain", "plane-strain", "bonded", "capped"]))
            geometry |= {"length_mm": float(f"{inner * draw(size(0.3, 2.0)):.3g}"), "ends": ends}
        load["pressure_kpa"] = draw(loads(mu * math.log(ratio), 0.02, 1.5))
    elif kind == "ring":
        geometry, quantities = radii | {"waves": draw(st.sampled_from([2, 3]))}, ("crossing_kpa", "bore_mm")
        load["kind"] = draw(st.sampled_from(["external", "dead"]))
        load["pressure_kpa"] = draw(loads(mu * (ratio - 1.0) ** 3, 0.1, 5.0))
    elif kind == "block":
        geometry, quantities = {"kind": kind, "edge_mm": draw(size(0.1, 500.0))}, ("crossing_kpa",)
        load["tension_kpa"] = draw(loads(2.0 * mu, 0.2, 1.6))
    elif kind == "cook":
        geometry, quantities = {"kind": kind}, ("corner_mm",)
        load["traction_kpa"] = draw(loads(mu, 1e-3, 0.2))
    elif kind == "cylinder":
        length = float(f"{inner * draw(size(0.5, 3.0)):.3g}")
        geometry, quantities = {"kind": kind, "radius_mm": inner, "length_mm": length}, ("torque_nmm", "axial_force_n")
        load["twist_rad_per_mm"] = float(f"{draw(st.sampled_from([-1.0, 1.0])) * draw(size(0.02, 1.0)) / inner:.3g}")
    else:
        along = float(f"{inner * draw(size(0.8, 3.0)):.3g}")
        geometry, quantities = {"kind": kind, "inner_across_mm": inner, "inner_along_mm": along}, ("apex_inside_mm",)
        geometry |= {"outer_across_mm": outer, "outer_along_mm": round(along + outer - inner, 4)}
        geometry["base_mm"] = round(along * draw(st.floats(0.0, 0.7)), 3)
        load["pressure_kpa"] = draw(loads(mu * math.log(ratio), 0.02, 1.5))
    scene = {"geometry": geometry, "material": material, "load": load, "ask": draw(asks(quantities))}
    if kind not in ("ring", "block", "cook"):
        scene["mesh"] = {"element": draw(seldom(st.sampled_from(["hex", "tet", "tet-p0", "tet-p1"]), "auto", 4))}
    return scene


# ---- absurd ------------------------------------------------------------------------------------------------


@st.composite
def spoilt(draw: st.DrawFn, scene: Contents) -> Contents:
    """A scene with one key of one of its tables absurd, missing, misspelt, or in the wrong table."""
    table = draw(st.sampled_from(sorted(scene)))
    key = draw(st.sampled_from(sorted(scene[table])))
    changed = {name: dict(content) for name, content in scene.items()}
    how = draw(st.sampled_from(["absurd", "absurd", "absurd", "missing", "misspelt", "elsewhere", "no table"]))
    if how == "absurd":
        changed[table][key] = draw(st.sampled_from(ABSURD))
    elif how == "no table":
        del changed[table]
    else:
        value = changed[table].pop(key)
        if how == "misspelt":
            changed[table][key[:-1] + "x"] = value
        elif how == "elsewhere":
            changed[draw(st.sampled_from(sorted(changed)))][key] = value
    return changed
