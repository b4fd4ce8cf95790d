"""The rule that picks a reference and two alternates from the sets that fit."""

from __future__ import annotations

import numpy as np

from analytical.bellows.fit.members import CORRECTED_CHAIN, Chain, FitError, Members, wall_stretch


def reference(members: Members, chain: Chain = CORRECTED_CHAIN) -> int:
    """Index of the reference: one silicone per wall thickness if any fits so, then the smallest wall stretch.

    The wall stretch is the largest lambda_a of the four at 20 kPa; of equal ones the smallest worst error.
    Members are those that are admissible otherwise: mass, buildable, dimensions as on a drawing.
    """
    if not len(members):
        raise FitError("no member to pick from: widen the grid or the allowed error")
    preferred = members.one_silicone_per_wall
    candidates = np.flatnonzero(preferred) if np.any(preferred) else np.arange(len(members))
    # Stretches of equal R_p differ by round-off only.
    stretch = np.round(wall_stretch(members, chain).max(axis=1)[candidates], 9)
    return int(candidates[np.lexsort((members.worst_error[candidates], stretch))[0]])


def alternates(members: Members, chosen: int) -> tuple[int, int]:
    """Indices of the alternates: other n with the same silicones, and other silicones; smallest worst error each."""
    same = np.all(members.silicone == members.silicone[chosen], axis=1)
    picks = []
    for mask, what in ((same & (members.convolutions != members.convolutions[chosen]), "n"), (~same, "silicones")):
        if not np.any(mask):
            raise FitError(f"no member with other {what} to pick as alternate: widen the grid or the allowed error")
        candidates = np.flatnonzero(mask)
        picks.append(int(candidates[np.argmin(members.worst_error[candidates])]))
    return picks[0], picks[1]
