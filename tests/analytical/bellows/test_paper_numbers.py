"""The printed numbers as data, and their look-up."""

from __future__ import annotations

import pytest

from analytical.bellows.paper import ALTERNATE_FAMILIES, FAMILIES, PRINTED, REFERENCE_FAMILY, actuators, printed
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30


def test_differences_named_in_the_text() -> None:
    first = PRINTED[0]
    # printed with one decimal, so exact up to binary fractions
    assert first.experiment_cm - first.ansys_cm == pytest.approx(2.6, abs=1e-12)
    assert first.experiment_cm - first.closed_form_cm == pytest.approx(2.0, abs=1e-12)
    assert max(row.experiment_cm - row.ansys_cm for row in PRINTED) == first.experiment_cm - first.ansys_cm


def test_larger_root_elongates_less_in_every_column() -> None:
    for column in ("closed_form_cm", "ansys_cm", "experiment_cm"):
        for wall_mm in (1.0, 2.0):
            five, larger = sorted(
                (row for row in PRINTED if row.wall_mm == wall_mm), key=lambda row: row.has_larger_root
            )
            assert getattr(five, column) > getattr(larger, column)


def test_actuators_of_the_reference_family() -> None:
    names = [actuator.name for actuator in actuators()]
    assert names == ["heung-t1-ri5", "heung-t1-ri7", "heung-t2-ri5", "heung-t2-ri7"]
    assert [actuator.law for actuator in actuators()] == [DRAGON_SKIN_10] * 2 + [dragon_skin_30("2mu/alpha^2")] * 2
    assert tuple(actuator.printed for actuator in actuators()) == PRINTED


def test_look_up() -> None:
    for actuator in actuators():
        d = actuator.dimensions
        row = printed(d.wall_mm, d.root_radius_mm, d.crest_radius_mm, d.half_pitch_mm, d.convolutions)
        assert row is actuator.printed
    row = printed(wall_mm=2.0, root_radius_mm=5.0, crest_radius_mm=10.5, half_pitch_mm=5.0, convolutions=8)
    assert row is not None
    assert (row.closed_form_cm, row.ansys_cm, row.experiment_cm) == (5.3, 3.3, 5.0)


def test_another_actuator_has_no_printed_numbers() -> None:
    assert printed(1.0, 5.0, 10.5, 5.0, 3) is None
    assert printed(1.5, 5.0, 10.5, 5.0, 8) is None
    assert printed(1.0, 6.0, 10.5, 5.0, 8) is None
    # of an alternate, asked for among the reference only
    assert printed(1.0, 8.0, 14.0, 5.5, 4, families=(REFERENCE_FAMILY,)) is None


def test_alternates_differ_from_the_reference_in_silicone_or_in_n() -> None:
    for family in ALTERNATE_FAMILIES:
        assert (family.silicones, family.convolutions) != (REFERENCE_FAMILY.silicones, REFERENCE_FAMILY.convolutions)


def test_names_and_printed_numbers_of_the_alternates() -> None:
    named = [[actuator.name for actuator in actuators(family)] for family in FAMILIES]
    assert named[1] == ["heung-a-t1-ri5", "heung-a-t1-ri8", "heung-a-t2-ri5", "heung-a-t2-ri8"]
    assert named[2] == ["heung-b-t1-ri5", "heung-b-t1-ri7.5", "heung-b-t2-ri5", "heung-b-t2-ri7.5"]
    for family in FAMILIES:
        for actuator in actuators(family):
            d = actuator.dimensions
            found = printed(d.wall_mm, d.root_radius_mm, d.crest_radius_mm, d.half_pitch_mm, d.convolutions)
            assert found is actuator.printed
