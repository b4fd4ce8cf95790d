"""The volume that a rigid plate encloses: what it adds to the integral over the cavity's walls."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from solvers.discrete.domain import FloatArray


def enclosed_by_plate(motion_mm: FloatArray, arm_mm: float, area_mm2: float) -> tuple[float, FloatArray, FloatArray]:
    """Volume that a plate adds, with its derivatives by the plate's six unknowns.

    With the field (x, y, 0)/2 the plate's face contributes ``A/2 U . n`` (transverse parts), n = R e_z its normal:
    nothing as long as it keeps level or on the axis, but its second variation couples tilting and drifting.

    Parameters
    ----------
    motion_mm
        Its translation U, and its rotation vector times the arm, shape (6,).
    arm_mm, area_mm2
        The arm, and the plate's area A.

    Returns
    -------
    tuple
        mm^3; its derivative, mm^2, shape (6,); its second derivative, mm, shape (6, 6).
    """
    first, second = np.zeros(6), np.zeros((6, 6))
    half = 0.5 * area_mm2
    turn = Rotation.from_rotvec(motion_mm[3:] / arm_mm).as_matrix()
    spins = [np.cross(axis, np.eye(3)).T / arm_mm for axis in np.eye(3)]  # W_j, with W_j y = e_j x y / arm
    across = np.array([motion_mm[0], motion_mm[1], 0.0])
    flat = np.diag([1.0, 1.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    tilt = np.stack([turn @ w @ up for w in spins], axis=1)  # dn by rotations, columns
    first[:3], first[3:] = half * flat @ turn @ up, half * across @ tilt
    second[:3, 3:] = half * flat @ tilt
    second[3:, :3] = second[:3, 3:].T
    for i in range(3):
        for j in range(3):
            both = 0.5 * (spins[i] @ spins[j] + spins[j] @ spins[i])
            second[3 + i, 3 + j] = half * across @ turn @ both @ up
    return float(half * across @ turn @ up), first, second
