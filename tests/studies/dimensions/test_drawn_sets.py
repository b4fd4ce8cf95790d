"""The drawn sets: every one fits, can be built and may weigh what it does; the kept file is what the code draws."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytical.bellows.fit.masses import mass_allowed, silicone_g
from analytical.bellows.fit.members import BALANCED_CHAIN, CORRECTED_CHAIN, WITHIN, members_of
from analytical.bellows.fit.search import Grid, search
from analytical.bellows.paper import FAMILIES, REFERENCE_FAMILY, InferredFamily
from meshes.bellows import check_shape
from studies.dimensions import sets
from studies.dimensions.cases import Steps
from studies.dimensions.sets import CHOSEN, WANTED, draw_sets, fittings_of, latin_hypercube
from studies.scene.dimension_sets import CHAIN_OF, SETS_FILE, DimensionSet, read_sets, sets_csv


@pytest.fixture(scope="module")
def kept(root: Path) -> tuple[DimensionSet, ...]:
    return read_sets(root / "scenes" / SETS_FILE)


def family_of(one: DimensionSet) -> InferredFamily:
    silicones = (one.silicone_1, one.silicone_2, one.silicone_3, one.silicone_4)
    sizes = (one.larger_root_radius_mm, one.crest_radius_mm, one.half_pitch_mm, one.convolutions)
    return InferredFamily(*sizes, silicones)


def test_a_point_in_every_slice_of_every_axis() -> None:
    points = latin_hypercube(7, 3, np.random.default_rng(0))
    assert points.shape == (7, 3)
    assert np.array_equal(np.sort(np.floor(7 * points), axis=0), np.tile(np.arange(7.0)[:, None], 3))


def test_the_file_is_read_as_it_is_written(kept: tuple[DimensionSet, ...], root: Path) -> None:
    assert sets_csv(kept) == (root / "scenes" / SETS_FILE).read_text(encoding="utf-8")


def test_as_many_sets_as_wanted_each_by_its_own_name(kept: tuple[DimensionSet, ...]) -> None:
    assert Counter(one.kind for one in kept) == WANTED
    assert WANTED.keys() == CHAIN_OF.keys()
    assert len({one.name for one in kept}) == len(kept)


def test_every_set_fits_the_chain_of_its_kind(kept: tuple[DimensionSet, ...]) -> None:
    chains = {"corrected": CORRECTED_CHAIN, "balanced": BALANCED_CHAIN}
    for kind, chain in chains.items():
        of_kind = members_of(tuple(family_of(one) for one in kept if one.kind == kind), chain)
        assert of_kind.worst_error.max() <= WITHIN
    assert {family_of(one) for one in kept if one.kind == "reference"} == {REFERENCE_FAMILY}


def test_every_set_can_be_built_and_may_weigh_what_it_does(kept: tuple[DimensionSet, ...]) -> None:
    for one in kept:
        assert len(one.actuators) == 4
        for actuator in one.actuators:
            check_shape(one.shape(actuator))  # raises
        assert mass_allowed(silicone_g(members_of((family_of(one),)), fittings_of(one)))[0]
        for key, (low, high) in CHOSEN.items():
            assert low <= getattr(one, key) <= high


def test_what_is_refused_is_counted_and_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sets, "WANTED", {"corrected": 3, "balanced": 2, "reference": 4})
    members = members_of(FAMILIES)
    drawn = draw_sets(members, members)
    assert [len(kind.sets) for kind in drawn] == [3, 2, 4]
    assert drawn == draw_sets(members, members)
    # R_p - R_i = 3.5 mm has room for the arcs of a 2 mm wall up to fillets of 0.75 mm
    monkeypatch.setattr(sets, "CHOSEN", {**CHOSEN, "fillet_mm": (0.1, 3.0)})
    assert all(kind.unbuildable > 0 for kind in draw_sets(members, members))
    heavy = replace(members, convolutions=3 * members.convolutions)
    monkeypatch.setattr(sets, "CHOSEN", {**CHOSEN, "cap_mm": (0.1, 40.0)})
    assert draw_sets(heavy, members)[0].too_heavy_or_light > 0


def test_a_shallow_fold_is_no_member_with_room() -> None:
    shallow = members_of((replace(REFERENCE_FAMILY, larger_root_radius_mm=8.5), REFERENCE_FAMILY))
    assert draw_sets(shallow, shallow)[0].members == 1


@pytest.mark.slow
def test_the_kept_file_is_what_is_drawn(kept: tuple[DimensionSet, ...]) -> None:
    grid = Grid.regular(Steps().search_mm)
    drawn = draw_sets(search(grid, CORRECTED_CHAIN), search(grid, BALANCED_CHAIN))
    assert tuple(one for kind in drawn for one in kind.sets) == kept
    assert sets.sets_recorded(drawn).met
    assert not sets.sets_recorded(drawn[:2]).met
