"""What volumes on which a pressure does work are measured by: steps, tolerances and limits are shares of it."""

from __future__ import annotations

import math

# An unloaded volume measures others if it is so large beside the sphere whose surface is as large as the loaded one:
# bellows are at 0.3, a tube a hundred times as long as its radius at 0.2, slices of rings at up to some hundred.
LEAST, MOST = 0.1, 1e3


def volume_measure(unloaded_mm3: float, area_mm2: float) -> tuple[float, float]:
    """Where volumes are counted from, and their unit.

    A cavity's are counted from zero by its unloaded volume. A flat sheet has none, nor has one that is curved a little
    either way, and that of a sheet that stands upright says how far it is from the axis: their volumes are what the
    load sweeps, by the sphere whose surface is as large as the loaded one.

    Parameters
    ----------
    unloaded_mm3
        Volume on which the load does work in the unloaded state, of either sign.
    area_mm2
        Area of the loaded surface.

    Returns
    -------
    tuple of float
        Start and unit, mm^3; the unit is positive.
    """
    sphere = area_mm2**1.5 / (6.0 * math.sqrt(math.pi))
    if LEAST * sphere <= abs(unloaded_mm3) <= MOST * sphere:
        return 0.0, abs(unloaded_mm3)
    return unloaded_mm3, sphere
