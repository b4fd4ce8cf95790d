"""What looks like another unit in a scene that is otherwise sound, and what a run has stretched beyond its law's data.

Nothing here is refused: a scene may be meant so. Texts name the key, its value and what is usual.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analytical.laws.silicones import Silicone, silicone_of
from analytical.laws.stability import stable_stretches
from meshes.by_gmsh.user_mesh import read_user_mesh
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import (
    BlockGeometry,
    CylinderGeometry,
    MeshGeometry,
    RingGeometry,
    SphereGeometry,
    TubeGeometry,
    VentricleGeometry,
)
from studies.scene.load import Scene
from studies.scene.materials import AnyMaterial, law_of
from studies.scene.silicones.presets import preset_of

# Begins what is said of a law that softens.
LAW = "law: "
# Initial shear moduli of what is cast or moulded, kPa: from the softest gels to hard rubber.
LEAST_MODULUS_KPA, LARGEST_MODULUS_KPA = 1.0, 1e4
# Loads below this share of the modulus strain a body of any usual shape by less than can be seen.
LEAST_LOAD = 1e-3
# Of a thin ring it is the load at which it buckles, mu (t/R)^3 in size, of which this share is little.
LEAST_RING_LOAD = 1e-2
# Extent of a body, mm (a scene of micrometres is refused), and thickness relative to radius.
LEAST_MM, LEAST_THICKNESS = 2.0, 1.0 / 300.0
# Silicones have 1e3 and more; 100 is Poisson's ratio 0.495.
LEAST_KAPPA, LARGEST_KAPPA = 100.0, 1e6
# Stress of a tip's force over the wall's section, relative to the modulus.
LEAST_PULL, LARGEST_PULL = 1e-5, 3.0
# Beyond this a law whose data nobody has told is remarked on: about where the reference actuators are at the 20 kPa to
# which they were measured.
UNKNOWN_FROM_STRETCH = 4.0


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """What in a scene looks like another unit, a sentence each; empty where nothing does."""
    every = materials_of(scene)
    modulus = min(1e3 * law_of(of).initial_shear_modulus_mpa for of in every.values())  # others may be stiff layers
    found = [] if scene.geometry.kind == "cook" else modulus_warnings(modulus)  # a published problem, in MPa
    for key, of in every.items():
        found += kappa_warnings(of.kappa_over_mu, key)
    if isinstance(scene, BellowsScene):
        g = scene.geometry
        found += load_warnings(abs(scene.loads_kpa[-1]), modulus, "load.pressure_kpa")
        found += extent_warnings(2.0 * g.crest_radius_mm, "geometry.crest_radius_mm", g.crest_radius_mm)
        found += thickness_warnings(g.wall_mm, g.crest_radius_mm, "geometry.wall_mm")
        if g.tip == "cap":
            found += thickness_warnings(g.cap_mm, g.crest_radius_mm, "geometry.cap_mm")
        section = math.pi * g.wall_mm * (2.0 * g.root_radius_mm + g.wall_mm)
        return tuple(found + force_warnings(scene.load.tip_force_n, 1e-3 * modulus * section))
    return tuple(found + _body_warnings(scene, modulus))


def materials_of(scene: Scene) -> dict[str, AnyMaterial]:
    """The materials of a scene by their keys."""
    others = scene.materials if isinstance(scene, BodyScene) else {}
    return {"material": scene.material, **{f"materials.{name}": of for name, of in others.items()}}


def _body_warnings(scene: BodyScene, modulus_kpa: float) -> list[str]:
    """Of the loads and lengths of a simple body or a user's mesh."""
    g, load = scene.geometry, scene.load
    if isinstance(g, CylinderGeometry):
        found = twist_warnings((load.twist_rad_per_mm or 0.0) * g.length_mm)
        return found + extent_warnings(max(2.0 * g.radius_mm, g.length_mm), "geometry.radius_mm", g.radius_mm)
    key = next(f"load.{name}" for name in ("pressure_kpa", "tension_kpa", "traction_kpa") if getattr(load, name))
    if isinstance(g, RingGeometry):
        slender = (g.outer_radius_mm - g.inner_radius_mm) / g.outer_radius_mm
        found = load_warnings(scene.loads_kpa[-1], modulus_kpa, key, LEAST_RING_LOAD * slender**3)
    else:
        found = load_warnings(scene.loads_kpa[-1], modulus_kpa, key)
    if isinstance(g, TubeGeometry | SphereGeometry | RingGeometry):
        thickness, outer = g.outer_radius_mm - g.inner_radius_mm, g.outer_radius_mm
        found += extent_warnings(2.0 * outer, "geometry.outer_radius_mm", outer)
        found += thickness_warnings(thickness, outer, "geometry.outer_radius_mm less inner_radius_mm")
    if isinstance(g, TubeGeometry):
        found += thickness_warnings(g.length_mm, g.outer_radius_mm, "geometry.length_mm")
    if isinstance(g, VentricleGeometry):
        found += extent_warnings(2.0 * g.outer_along_mm, "geometry.outer_along_mm", g.outer_along_mm)
        found += thickness_warnings(
            g.outer_across_mm - g.inner_across_mm, g.outer_across_mm, "geometry.outer_across_mm less inner_across_mm"
        )
    if isinstance(g, BlockGeometry):
        found += extent_warnings(g.edge_mm, "geometry.edge_mm", g.edge_mm)
    if isinstance(g, MeshGeometry):
        extent = float(np.ptp(read_user_mesh(Path(g.file), g.scale).points, axis=0).max())
        found += extent_warnings(extent, "geometry.scale", g.scale)
    return found


def modulus_warnings(modulus_kpa: float) -> list[str]:
    """Of an initial shear modulus, kPa."""
    if LEAST_MODULUS_KPA <= modulus_kpa <= LARGEST_MODULUS_KPA:
        return []
    likely = "MPa" if modulus_kpa < LEAST_MODULUS_KPA else "Pa"
    return [
        f"material: the initial shear modulus is {modulus_kpa:.4g} kPa, elastomers have {LEAST_MODULUS_KPA:g} kPa to "
        f"{1e-3 * LARGEST_MODULUS_KPA:g} MPa: constants are in kPa; were they given in {likely}?"
    ]


def load_warnings(highest_kpa: float, modulus_kpa: float, key: str, least: float = LEAST_LOAD) -> list[str]:
    """Of the highest load, kPa, beside the modulus; ``least`` is the share of it below which a load is remarked on."""
    if highest_kpa >= least * modulus_kpa:
        return []
    return [
        f"{key} reaches {highest_kpa:g}: {highest_kpa / modulus_kpa:.2g} of the initial shear modulus, "
        f"{modulus_kpa:.4g} kPa, strains hardly anything: loads are in kPa; was it given in MPa?"
    ]


def kappa_warnings(kappa_over_mu: float, key: str = "material") -> list[str]:
    """Of the bulk modulus relative to the initial shear modulus, and the key of its material."""
    if kappa_over_mu < LEAST_KAPPA:
        poisson = (3.0 * kappa_over_mu - 2.0) / (6.0 * kappa_over_mu + 2.0)
        return [
            f"{key}.kappa_over_mu = {kappa_over_mu:g}: Poisson's ratio {poisson:.4g}, silicones have 1000 and more; "
            "inf is incompressible"
        ]
    if LARGEST_KAPPA < kappa_over_mu < math.inf:
        return [
            f"{key}.kappa_over_mu = {kappa_over_mu:g}: a ratio; was the bulk modulus itself given? inf is "
            "incompressible"
        ]
    return []


def extent_warnings(extent_mm: float, key: str, value: float) -> list[str]:
    """Of a body's size across, mm, which a key's value gives."""
    if extent_mm >= LEAST_MM:
        return []
    return [
        f"{key} = {value:g}: the body is {extent_mm:.3g} mm across: lengths are in mm; were metres or inches given?"
        + (" geometry.scale = 1000 or 25.4 makes them mm" if key == "geometry.scale" else "")
    ]


def thickness_warnings(thickness_mm: float, radius_mm: float, key: str) -> list[str]:
    """Of a wall, or a length, beside the radius of the same body, mm."""
    if thickness_mm >= LEAST_THICKNESS * radius_mm:
        return []
    return [
        f"{key} = {thickness_mm:.4g}: {thickness_mm / radius_mm:.1g} of the radius, {radius_mm:g} mm: are both in mm?"
    ]


def twist_warnings(angle_rad: float) -> list[str]:
    """Of the whole angle by which an end is turned, rad."""
    if abs(angle_rad) <= 2.0 * math.pi:
        return []
    return [
        f"load.twist_rad_per_mm turns the end by {angle_rad:.3g} rad, more than once round: it is in rad per mm of "
        "length; was it given in degrees?"
    ]


def force_warnings(force_n: float, strength_n: float) -> list[str]:
    """Of a force on the tip beside modulus times section of the wall, both N."""
    share = abs(force_n) / strength_n
    if force_n == 0.0 or LEAST_PULL <= share <= LARGEST_PULL:
        return []
    likely = "kN" if share < LEAST_PULL else "mN or grams"
    return [
        f"load.tip_force_n = {force_n:g}: {share:.2g} times modulus and section of the wall, {strength_n:.3g} N: it is "
        f"in N; was it given in {likely}?"
    ]


def law_range(material: AnyMaterial) -> str:
    """Up to which stretches a law that softens is stable, a sentence; empty for a law that is stable everywhere."""
    limits = stable_stretches(law_of(material))
    if all(math.isinf(limit) for limit in limits.values()):
        return ""
    told = ", ".join(f"{limit:.3g} ({mode})" for mode, limit in limits.items() if math.isfinite(limit))
    return f"{LAW}stable up to stretch {told}: a path that comes there stops"


def law_ranges(scene: Scene) -> list[str]:
    """`law_range` of the materials of a scene that soften, each with its key where there are several."""
    every = materials_of(scene)
    told = {key: law_range(of) for key, of in every.items()}
    keyed = len(every) > 1
    return [text.replace(LAW, f"{LAW}{key} is ", 1) if keyed else text for key, text in told.items() if text]


def stretch_warnings(scene: Scene, stretches: Sequence[tuple[float, float]]) -> list[str]:
    """What was stretched beyond the silicone's elongation at break, or the law's data, a sentence each.

    Of several materials, the largest stretch may be in any: each is told with its key.

    Parameters
    ----------
    scene
        The scene.
    stretches
        Loads, kPa, in order, and the largest stretch at each.
    """
    every = materials_of(scene)
    return [
        f"{text}; if it is in {key}" if len(every) > 1 else text
        for key, material in every.items()
        for text in _material_stretches(material, stretches)
    ]


def _material_stretches(material: AnyMaterial, stretches: Sequence[tuple[float, float]]) -> list[str]:
    """The same of one material."""
    law, known = law_of(material), material.data_to_stretch
    printed, named = silicone_of(law), preset_of(law)
    silicone = printed or (named and Silicone(named.title, named.stretch_at_break, named.source))
    found = []
    if silicone is not None and (first := _first(stretches, silicone.stretch_at_break)):
        found.append(f"{first}: {silicone.name} breaks at {silicone.stretch_at_break:g} ({silicone.source})")
    if known is not None and (first := _first(stretches, known)):
        found.append(f"{first}: beyond the law's data, which go to {known:g} (material.data_to_stretch)")
    if known is None and (first := _first(stretches, UNKNOWN_FROM_STRETCH)):
        limit = f"; {silicone.name} breaks at {silicone.stretch_at_break:g}" if silicone and not found else ""
        unknown = "up to which stretch the law's data go is unknown (tell it in material.data_to_stretch)"
        found.append(f"{first}: {unknown}{limit}")
    return found


def _first(stretches: Sequence[tuple[float, float]], limit: float) -> str:
    """Where the largest stretch first exceeds a limit, and how far it comes; empty if it does not."""
    beyond = [(load, stretch) for load, stretch in stretches if stretch > limit]
    if not beyond:
        return ""
    (first, at_first), (last, at_last) = beyond[0], beyond[-1]
    further = f", to {at_last:.3g} at {last:g} kPa" if last != first else ""
    return f"the largest stretch is {at_first:.3g} at {first:g} kPa{further}"
