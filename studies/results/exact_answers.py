"""Exact answers of the scenes that have one; NaN and an empty source where there is none."""

from __future__ import annotations

import math

from analytical.exact import compressible, cube, ring, sphere, torsion, tube
from analytical.exact.compressible import CompressibleError
from analytical.exact.cube import CubeError
from analytical.exact.ring import RingError
from analytical.exact.sphere import SphereError
from analytical.exact.tube import TubeError
from analytical.laws.stability import stable_stretches
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import (
    CookGeometry,
    CylinderGeometry,
    RingGeometry,
    SphereGeometry,
    TubeGeometry,
    VentricleGeometry,
)
from studies.scene.materials import GuccioneMaterial, NeoHookeMaterial, inverse_kappa, law_of

Answer = tuple[float, str]
NONE: Answer = (math.nan, "")

# Cook's membrane with the numbers of Simo and Armero (Int. J. Numer. Meth. Eng. 33 (1992) 1413), incompressible. No
# printed digits were found, so the reference is this program's own: meshes n8, n16, n32, n48 give 6.92236, 6.93051,
# 6.93260, 6.93310 mm, and the limit is known to 0.0005 mm (a slow test in tests/studies/verification).
COOK_MATERIAL = NeoHookeMaterial(law="neo-hooke", mu_kpa=80193.8)
COOK_KPA, COOK_CORNER_MM = 6250.0, 6.9335
# Land et al. 2015, problem 2: geometry, material, pressure in kPa, and the position of the apex inside, apex down.
LAND_PROBLEM_2 = (
    VentricleGeometry(
        kind="ventricle",
        inner_across_mm=7.0,
        inner_along_mm=17.0,
        outer_across_mm=10.0,
        outer_along_mm=20.0,
        base_mm=5.0,
    ),
    GuccioneMaterial(law="guccione", c_kpa=10.0),
    10.0,
)
LAND_SOURCE = "published: Land et al. 2015, problem 2 (about; the groups differ by 0.5 %)"
LAND_APEX_MM = {"apex_inside_mm": -26.6}


def known_value(scene: BodyScene, quantity: str, load_kpa: float) -> Answer:
    """What is known of a quantity at a load, in its unit, and where it comes from: exact, published, or refined."""
    g = scene.geometry
    if quantity == "bore_mm":
        return exact_bore_mm(scene, load_kpa)
    if isinstance(g, CylinderGeometry) and inverse_kappa(scene.material) == 0.0:
        body = torsion.TwistedCylinder(g.radius_mm, scene.load.twist_rad_per_mm or 0.0)
        law, source = law_of(scene.material), "exact: torsion of an incompressible cylinder (Rivlin 1949)"
        shear = 0.5 * abs(body.twist_rad_per_mm) * g.radius_mm
        if shear + math.hypot(1.0, shear) > stable_stretches(law)["pure shear"]:
            return NONE
        return (torsion.torque_nmm if quantity == "torque_nmm" else torsion.axial_force_n)(body, law), source
    if isinstance(g, CookGeometry) and scene.material == COOK_MATERIAL and load_kpa == COOK_KPA:
        return COOK_CORNER_MM, "own: limit of refined meshes"
    if isinstance(g, VentricleGeometry) and (g, scene.material, load_kpa) == LAND_PROBLEM_2:
        return LAND_APEX_MM.get(quantity, math.nan), LAND_SOURCE
    return NONE


def exact_bore_mm(scene: BodyScene, load_kpa: float) -> Answer:
    """Radial displacement of the bore at a load, mm, and where it comes from; of a ring, while it is round.

    None where the law is no longer stable at the bore.
    """
    value, source = _bore_by_law(scene, 1e-3 * load_kpa)
    g = scene.geometry
    if isinstance(g, TubeGeometry | RingGeometry | SphereGeometry):
        stretch = 1.0 + value / g.inner_radius_mm
        mode = "equibiaxial" if isinstance(g, SphereGeometry) else "pure shear"
        if max(stretch, 1.0 / stretch) > stable_stretches(law_of(scene.material))[mode]:
            return NONE
    return value, source


def _bore_by_law(scene: BodyScene, load: float) -> Answer:
    g = scene.geometry
    try:
        if isinstance(g, TubeGeometry) and g.ends != "bonded":
            return _tube_bore(scene, tube.Tube(g.inner_radius_mm, g.outer_radius_mm), g.ends, load)
        if isinstance(g, RingGeometry):
            body = tube.Tube(g.inner_radius_mm, g.outer_radius_mm)
            return _ring_bore(scene, body, load)
        if isinstance(g, SphereGeometry):
            return _sphere_bore(scene, sphere.Sphere(g.inner_radius_mm, g.outer_radius_mm), load)
    except (TubeError, SphereError, CompressibleError):
        return NONE  # beyond what the body carries
    return NONE


def _tube_bore(scene: BodyScene, body: tube.Tube, ends: str, load: float) -> Answer:
    law, softness = law_of(scene.material), inverse_kappa(scene.material)
    if ends == "capped":
        if softness > 0.0:
            return NONE
        state = tube.state_at_pressure(body, law, load, "capped")
        return state.inner_mm - body.inner_radius_mm, "exact: tube with capped ends"
    if softness > 0.0:
        found = compressible.state_at_pressure(body, law, 1.0 / softness, load)
        return found.inner_mm - body.inner_radius_mm, "exact: compressible tube in plane strain"
    inner = tube.inner_radius_at_pressure_mm(body, law, load)
    return inner - body.inner_radius_mm, "exact: tube in plane strain"


def _sphere_bore(scene: BodyScene, body: sphere.Sphere, load: float) -> Answer:
    law, softness = law_of(scene.material), inverse_kappa(scene.material)
    if softness > 0.0:
        found = compressible.state_at_pressure(body, law, 1.0 / softness, load)
        return found.inner_mm - body.inner_radius_mm, "exact: compressible sphere"
    limit = sphere.limit_point(body, law)
    if limit is None or load <= limit.pressure_mpa:
        return sphere.inner_radius_at_pressure_mm(body, law, load) - body.inner_radius_mm, "exact: sphere"
    beyond = sphere.inner_radius_beyond_limit_mm(body, law, load) - body.inner_radius_mm
    return beyond, "exact: sphere beyond its limit point"


def _ring_bore(scene: BodyScene, body: tube.Tube, load: float) -> Answer:
    """The round ring; its pressure counts per deformed area if it follows, per undeformed area if it is dead."""
    law = law_of(scene.material)
    if inverse_kappa(scene.material) > 0.0:
        return NONE

    def outside(inner_mm: float) -> float:
        """Pressure outside, negative as in analytical.tube, as it is given in the scene."""
        pressure = tube.pressure_at_inner_radius_mpa(body, law, inner_mm)
        if scene.load_kind == "external":
            return pressure
        outer = float(tube.deformed_radius_mm(body, inner_mm, body.outer_radius_mm))
        return pressure * outer / body.outer_radius_mm

    start = body.inner_radius_mm
    inner, _ = tube.first_solution(outside, start, (ring.INNER_STRETCH_MIN * start, 2.0 * start), -load)
    return (math.nan, "") if inner is None else (inner - start, "exact: round ring in plane strain")


def exact_crossing_kpa(scene: BodyScene) -> Answer:
    """Load at which stability is lost, kPa as in the scene, and where it comes from."""
    g, law = scene.geometry, law_of(scene.material)
    if inverse_kappa(scene.material) > 0.0:
        return NONE
    try:
        if isinstance(g, RingGeometry):
            body = tube.Tube(g.inner_radius_mm, g.outer_radius_mm)
            if scene.load_kind == "external":
                pressure = ring.first_buckling(body, law, g.waves, "follower").pressure_mpa
                return 1e3 * pressure, f"exact: follower pressure, {g.waves} waves, per deformed area"
            nominal = ring.first_buckling(body, law, g.waves, "dead").nominal_pressure_mpa
            return 1e3 * nominal, f"exact: dead pressure, {g.waves} waves, per undeformed area"
        if isinstance(g, SphereGeometry):
            limit = sphere.limit_point(sphere.Sphere(g.inner_radius_mm, g.outer_radius_mm), law)
            if limit is None or limit.inner_mm > stable_stretches(law)["equibiaxial"] * g.inner_radius_mm:
                return NONE
            return 1e3 * limit.pressure_mpa, "exact: limit point of the sphere"
        if g.kind == "block":
            return 1e3 * cube.trivial_limit_mpa(law), "exact: Rivlin's cube, T = 2 mu"
    except (RingError, SphereError, CubeError):
        return NONE
    return NONE
