"""The paper's four actuators and the two chains that hold, as parameters of tests."""

from __future__ import annotations

import pytest

from analytical.bellows.paper import actuators
from analytical.bellows.reading import BALANCED, CORRECTED

ACTUATORS = actuators()
every_actuator = pytest.mark.parametrize("actuator", ACTUATORS, ids=[actuator.name for actuator in ACTUATORS])
every_chain = pytest.mark.parametrize("reading", [CORRECTED, BALANCED], ids=["corrected", "balanced"])
