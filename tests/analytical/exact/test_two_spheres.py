"""Two spheres on one cavity: where the volume turns back, by the condition itself and by differences."""

from __future__ import annotations

import pytest

from analytical.exact.sphere import Sphere, SphereError, limit_point, pressure_at_inner_radius_mpa
from analytical.exact.two_spheres import TwoSpheres
from analytical.laws.isotropic import NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10

LAW = NeoHooke(0.1)
PAIR = TwoSpheres(Sphere(5.0, 6.5), Sphere(15.0, 19.7))


def compliance(sphere: Sphere, inner_mm: float) -> float:
    """dV/dP of one sphere over 2 pi, by central differences of the pressure."""
    h = 1e-4
    ends = [pressure_at_inner_radius_mpa(sphere, LAW, inner_mm + d) for d in (-h, h)]
    return inner_mm**2 * 2.0 * h / (ends[1] - ends[0])


def test_compliances_cancel_where_the_volume_turns() -> None:
    back, forward = PAIR.folds(LAW)
    limit = PAIR.limit(LAW)
    assert limit.stretch < back.stretch < forward.stretch
    assert limit.pressure_mpa > back.pressure_mpa > forward.pressure_mpa
    # it turns back by a fifth of the volume
    assert forward.volume_mm3 < 0.82 * back.volume_mm3
    for fold in (back, forward):
        small = fold.stretch * 5.0
        large = ((fold.volume_mm3 / (2.0 / 3.0 * 3.141592653589793)) - small**3) ** (1.0 / 3.0)
        assert pressure_at_inner_radius_mpa(PAIR.large, LAW, large) == pytest.approx(fold.pressure_mpa, rel=1e-9)
        # the volume is stationary: its place is known to the root of what the volume is
        assert compliance(PAIR.small, small) == pytest.approx(-compliance(PAIR.large, large), rel=1e-3)


def test_limit_is_that_of_the_small_sphere() -> None:
    top = limit_point(PAIR.small, LAW)
    assert top is not None
    assert PAIR.limit(LAW).pressure_mpa == pytest.approx(top.pressure_mpa, rel=1e-12)


def test_pairs_that_do_not_turn_back_are_refused() -> None:
    with pytest.raises(SphereError, match="take a larger second sphere"):
        TwoSpheres(Sphere(5.0, 6.5), Sphere(7.5, 9.85)).folds(LAW)
    with pytest.raises(SphereError, match="has to have the lower one"):
        TwoSpheres(PAIR.large, PAIR.small).limit(LAW)
    with pytest.raises(SphereError, match="has no limit point"):
        PAIR.limit(DRAGON_SKIN_10)
