"""The fit of the unprinted dimensions: complete on its grid, right in its numbers, and the rule that picks."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDimensions
from analytical.bellows.fit.masses import Fittings, mass_allowed, rings_g, silicone_g
from analytical.bellows.fit.members import (
    BALANCED_CHAIN,
    CORRECTED_CHAIN,
    CORRECTED_CHAIN_BY_20,
    ORDERS,
    PRINTED_CHAIN,
    SILICONES,
    TEXT_ORDER,
    WITHIN,
    Chain,
    FitError,
    Members,
    ReadingOrder,
    members_of,
    per_actuator,
    tip_mm,
    wall_stretch,
)
from analytical.bellows.fit.picks import alternates, reference
from analytical.bellows.fit.refine import refine
from analytical.bellows.fit.search import Grid, search
from analytical.bellows.paper import FAMILIES, LAWS, PRINTED, REFERENCE_FAMILY, actuators
from analytical.bellows.reading import BALANCED, CORRECTED, PRINTED_READING

FITTINGS = Fittings(cap_mm=5.0, collar_mm=3.0, seat_mm=4.0, ring_height_mm=2.0)
SMALL = Grid(
    crest_radius_mm=np.array([8.5, 10.5, 21.5]),
    larger_root_radius_mm=np.array([6.5, 7.0, 8.0]),
    half_pitch_mm=np.array([2.5, 5.0, 6.5, 9.0]),
    most_convolutions=13,
)
CHAINS = (CORRECTED_CHAIN, BALANCED_CHAIN, PRINTED_CHAIN, CORRECTED_CHAIN_BY_20)
READINGS = {"corrected chain": CORRECTED, "balanced chain": BALANCED, "printed chain": PRINTED_READING}


def key(members: Members) -> list[tuple[object, ...]]:
    """What tells a member from the others, one line each."""
    return [
        (
            *members.silicone[i],
            members.order[i],
            members.crest_radius_mm[i],
            members.larger_root_radius_mm[i],
            members.half_pitch_mm[i],
            members.convolutions[i],
        )
        for i in range(len(members))
    ]


def by_loops(grid: Grid, chain: Chain, within: float) -> dict[tuple[object, ...], list[float]]:
    """The same search, one actuator at a time: errors by key."""
    found = {}
    lengths = itertools.product(grid.crest_radius_mm, grid.larger_root_radius_mm, grid.half_pitch_mm)
    for crest, root, pitch in ((crest, root, pitch) for crest, root, pitch in lengths if root < crest):
        tip_of_one = {}
        for (k, row), (s, name) in itertools.product(enumerate(PRINTED), enumerate(SILICONES)):
            size = BellowsDimensions(root if row.has_larger_root else 5.0, crest, row.wall_mm, pitch, 1)
            path = closed_form(size, chain.laws[name], 20.0, chain.reading)
            past = path.state[0] == "past the model"
            tip_of_one[k, s] = math.nan if past else 0.1 * float(path.elongation_mm[0])
        for silicone in itertools.product((0, 1), repeat=4):
            for order, turned in enumerate(ORDERS):
                ratio = [tip_of_one[k, s] / turned.closed_form_cm[k] for k, s in enumerate(silicone)]
                for n in range(1, grid.most_convolutions + 1):
                    errors = [n * r - 1.0 for r in ratio]
                    # not a NaN among them
                    if all(abs(error) <= within for error in errors):
                        found[(*silicone, order, crest, root, pitch, n)] = errors
    return found


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: chain.label)
def test_search_finds_what_loops_find(chain: Chain) -> None:
    # 30 % so that there is something to find in every chain; 1e-6 keeps round-off at the bound out of it
    wide = by_loops(SMALL, chain, 0.3 + 1e-6)
    narrow = {entry for entry, errors in wide.items() if max(map(abs, errors)) <= 0.3 - 1e-6}
    members = search(SMALL, chain, within=0.3)
    assert len(members) > 0
    assert len(set(key(members))) == len(members)
    assert narrow <= set(key(members)) <= set(wide)
    for entry, error in zip(key(members), members.error, strict=True):
        # the same equations, alone and in arrays: round-off of the root finders
        assert error == pytest.approx(wide[entry], abs=1e-9)


def test_orders_give_each_pair_both_ways() -> None:
    assert list(ReadingOrder(False, False).closed_form_cm) == [12.1, 6.6, 3.8, 5.3]  # as the text names them
    assert list(ReadingOrder(True, True).closed_form_cm) == [6.6, 12.1, 5.3, 3.8]
    assert list(ORDERS[TEXT_ORDER].closed_form_cm) == [row.closed_form_cm for row in PRINTED]
    assert str(ORDERS[TEXT_ORDER]) == "1 mm as named, 2 mm reversed"
    assert len(set(ORDERS)) == 4


def test_grid_starts_where_the_rule_does() -> None:
    grid = Grid.regular(0.5, crest_to_mm=7.0, half_pitch_to_mm=4.0, most_convolutions=3)
    assert list(grid.crest_radius_mm) == [5.5, 6.0, 6.5, 7.0]
    assert list(grid.larger_root_radius_mm) == [5.5, 6.0, 6.5]
    assert list(grid.half_pitch_mm) == [2.5, 3.0, 3.5, 4.0]
    # 6 pairs with R_i < R_p, 4 pitches, 3 n, 16 silicones, 4 orders
    assert grid.combinations == 6 * 4 * 3 * 16 * 4
    for step_mm in (0.0, -1.0, math.nan, 6.0):
        with pytest.raises(FitError, match="step_mm"):
            Grid.regular(step_mm)


def test_every_set_reads_the_pairs_as_the_text_does() -> None:
    members = search(Grid.regular(0.5))
    assert set(members.order) == {TEXT_ORDER}
    assert members.worst_error.max() <= WITHIN
    # at (3) of the paper only: in the convention of (20) what fits contradicts the text
    assert TEXT_ORDER not in set(search(Grid.regular(0.5), CORRECTED_CHAIN_BY_20).order)
    assert TEXT_ORDER not in set(search(Grid.regular(0.5), PRINTED_CHAIN).order)
    # the column does not tell the chains apart
    assert TEXT_ORDER in set(search(Grid.regular(0.5), BALANCED_CHAIN).order)


def test_nothing_fits_beyond_the_grid_but_for_long_pitches() -> None:
    members = search(Grid.regular(0.5))
    grid = Grid.regular(0.5)
    # a fifth of the range is left free above
    assert members.crest_radius_mm.max() < 0.8 * grid.crest_radius_mm[-1]
    assert members.convolutions.max() < 0.8 * grid.most_convolutions
    assert members.half_pitch_mm.min() > grid.half_pitch_mm[0]
    beyond = search(Grid.regular(0.5, half_pitch_to_mm=30.0))
    assert np.any(beyond.half_pitch_mm > grid.half_pitch_mm[-1])


def test_recorded_families_are_members() -> None:
    members = members_of(FAMILIES)
    errors = [
        [
            0.1 * float(closed_form(a.dimensions, a.law, 20.0).elongation_mm[0]) / a.printed.closed_form_cm - 1.0
            for a in f
        ]
        for f in map(actuators, FAMILIES)
    ]
    assert members.error == pytest.approx(np.array(errors), abs=1e-12)
    assert members.worst_error.max() <= WITHIN
    assert tuple(members.family(i, f.label) for i, f in enumerate(FAMILIES)) == FAMILIES
    # three digits each
    assert members.worst_error == pytest.approx([0.0361, 0.0344, 0.0170], abs=5e-5)
    assert wall_stretch(members).max(axis=1) == pytest.approx([1.653, 1.962, 1.653], abs=5e-4)


def test_recorded_families_are_among_what_the_search_finds() -> None:
    found = set(key(search(Grid.regular(0.5))))
    assert set(key(members_of(FAMILIES))) <= found


def test_numbers_per_actuator() -> None:
    members = members_of(FAMILIES)
    for chain, reading in ((chain, READINGS[chain.label]) for chain in CHAINS[:2]):
        tips = tip_mm(members, 12.0, chain)
        for k, family in enumerate(FAMILIES):
            for j, actuator in enumerate(actuators(family)):
                path = closed_form(actuator.dimensions, actuator.law, 12.0, reading)
                # alone and in arrays: round-off of the root finders
                assert tips[k, j] == pytest.approx(float(path.elongation_mm[0]), rel=1e-9)
    # the second actuator of the reference folds back as printed
    assert math.isnan(tip_mm(members, 20.0, PRINTED_CHAIN)[0, 1])
    moduli = per_actuator(members, lambda d, law: np.full(d.shape, law.initial_shear_modulus_mpa))
    expected = [[LAWS[name].initial_shear_modulus_mpa for name in f.silicones] for f in FAMILIES]
    assert moduli == pytest.approx(np.array(expected), rel=1e-15)


def test_family_of_another_order_is_refused() -> None:
    members = replace(members_of(FAMILIES), order=np.zeros(3, dtype=int))
    with pytest.raises(FitError, match="order"):
        members.family(0)


def test_refined_is_a_local_best() -> None:
    start = members_of(FAMILIES[2:])
    best = refine(start)
    assert len(best) == 1
    assert best.worst_error[0] < start.worst_error[0]
    assert (best.silicone == start.silicone).all()
    assert best.convolutions[0] == start.convolutions[0]
    assert best.error == pytest.approx(members_of((best.family(0),)).error, abs=1e-12)
    # Steps of 0.02 mm any way do not better it by more than the 1e-8 that was asked of the minimum's value, with
    # room for a minimum that is flat along a valley.
    steps = np.random.default_rng(1).normal(size=(200, 3))
    steps *= 0.02 / np.linalg.norm(steps, axis=1)[:, None]
    around = best.take(np.zeros(200, dtype=int))
    around = replace(
        around,
        crest_radius_mm=around.crest_radius_mm + steps[:, 0],
        larger_root_radius_mm=around.larger_root_radius_mm + steps[:, 1],
        half_pitch_mm=around.half_pitch_mm + steps[:, 2],
    )
    errors = np.abs(tip_mm(around) / (10.0 * ORDERS[TEXT_ORDER].closed_form_cm) - 1.0).max(axis=1)
    assert errors.min() >= best.worst_error[0] - 1e-6


def test_refining_gives_one_set_per_choice() -> None:
    members = search(SMALL, within=0.1)
    best = refine(members)
    choices = {
        (*s, o, n) for s, o, n in zip(members.silicone.tolist(), members.order, members.convolutions, strict=True)
    }
    assert len(best) == len(choices)
    assert (np.diff(best.worst_error) >= 0.0).all()
    assert len(refine(members.take(np.array([], dtype=int)))) == 0


# --- mass -----------------------------------------------------------------------------------


def test_masses_of_the_reference() -> None:
    members = members_of((REFERENCE_FAMILY,))
    # nine rings of 4 x 2 mm on r = 11.5 mm, 1.24 g/cm3
    assert rings_g(members, FITTINGS)[0, 0] == pytest.approx(
        9 * 1.24e-3 * math.pi * (13.5**2 - 11.5**2) * 4.0, rel=1e-12
    )
    # sixteen cone shells by Pappus: slant l, thickness 1 mm, middle surface t/2 outside the cavity side
    slant = math.hypot(3.0, 5.5)
    cones = 16 * slant * 1.0 * 2.0 * math.pi * (0.5 * (5.0 + 10.5) + 0.5 * 3.0 / slant)
    tube = math.pi * (11.5**2 - 10.5**2) * (8 * 4.0 + 2 * 3.0)
    cap = math.pi * 11.5**2 * 5.0
    assert silicone_g(members, FITTINGS)[0, 0] == pytest.approx(1.07e-3 * (cones + tube + cap), rel=1e-12)


def test_mass_window_is_of_the_mean() -> None:
    # 19 g and 40 %: 11.4 to 26.6 g
    means = np.array([11.3, 11.5, 19.0, 26.5, 26.7])
    spread = np.array([-9.0, -1.0, 1.0, 9.0])
    assert list(mass_allowed(means[:, None] + spread)) == [False, True, True, True, False]


# --- the rule -------------------------------------------------------------------------------


def made(*entries: tuple[tuple[int, int, int, int], float, int, float]) -> Members:
    """Members from silicones, R_p, n and worst error."""
    silicone, crest, n, worst = zip(*entries, strict=True)
    m = len(entries)
    return Members(
        silicone=np.array(silicone),
        order=np.full(m, TEXT_ORDER),
        crest_radius_mm=np.array(crest),
        larger_root_radius_mm=np.full(m, 7.0),
        half_pitch_mm=np.full(m, 5.0),
        convolutions=np.array(n),
        error=np.array(worst)[:, None] * np.array([1.0, -0.5, 0.0, 0.2]),
    )


PURE, MIXED, OTHER = (0, 0, 1, 1), (0, 0, 1, 0), (0, 1, 1, 1)


def test_reference_has_one_silicone_per_wall_and_the_smallest_wall_stretch() -> None:
    # with Dragon Skin 10 and R_i = 5 the largest wall stretch grows with R_p
    members = made((MIXED, 9.0, 8, 0.01), (PURE, 12.0, 5, 0.01), (PURE, 10.5, 8, 0.04), (PURE, 10.5, 8, 0.03))
    assert reference(members) == 3
    # none with one silicone per wall: the rest stands
    assert reference(members.take(np.array([0]))) == 0
    with pytest.raises(FitError, match="no member"):
        reference(members.take(np.array([], dtype=int)))


def test_alternates_differ_in_n_and_in_silicone() -> None:
    members = made(
        (PURE, 10.5, 8, 0.03),
        (PURE, 10.5, 8, 0.001),  # same n: no alternate
        (PURE, 14.0, 4, 0.02),
        (PURE, 12.0, 5, 0.01),
        (MIXED, 10.5, 8, 0.02),
        (OTHER, 9.0, 12, 0.015),
    )
    assert alternates(members, 0) == (3, 5)
    with pytest.raises(FitError, match="other n"):
        alternates(members.take(np.array([0, 1, 4])), 0)
    with pytest.raises(FitError, match="other silicones"):
        alternates(members.take(np.array([0, 2])), 0)
