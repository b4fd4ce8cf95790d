"""A 3D view packed for a page: positions to 1/65535 of the body's box, stretches to 1/255 of their range."""

from __future__ import annotations

import base64
import math
import zlib
from dataclasses import asdict
from typing import Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from studies.report.pictures.bodies import flat_pieces
from studies.report.viewer.fields import View

# The colours of the half sections.
_COLOURS: Final = "YlOrRd"
_SAMPLES: Final = 33
# Bodies of more faces are drawn with fewer flat pieces to a face.
_MANY_FACES: Final = 8000
_FEW_PIECES, _PIECES = 2, 4


def pack(view: View) -> dict[str, Any]:
    """What the page's script is given, ready for JSON.

    ``data`` is base64 of a zlib stream of, one after the other: the faces' nodes (nodes of a face, faces) as uint32,
    positions (states, 3, nodes) as uint16, stretches (states, nodes) and whether a face is rigid (faces,) as uint8,
    little-endian. A position is ``origin`` + ``step`` times its three numbers, mm; a stretch is 1 + (``top`` - 1)
    times its number / 255.
    """
    positions = np.stack([state.points_mm for state in view.states])
    low, high = positions.min(axis=(0, 1)), positions.max(axis=(0, 1))
    step = np.maximum(high - low, 1e-9) / 65535.0
    stretches = np.stack([state.stretch for state in view.states])
    top = max(float(stretches[:, _soft_nodes(view)].max()), 1.0 + 1e-6)
    shares = np.clip((stretches - 1.0) / (top - 1.0), 0.0, 1.0)
    faces = view.surface.faces
    # Like numbers beside each other are what zlib makes small: all x, then all y, then all z.
    arrays = (
        faces.T.astype("<u4"),
        np.round((positions - low) / step).transpose(0, 2, 1).astype("<u2"),
        np.round(255.0 * shares).astype("u1"),
        view.surface.rigid.astype("u1"),
    )
    weights, triangles = flat_pieces(faces.shape[1], _FEW_PIECES if len(faces) > _MANY_FACES else _PIECES)
    return {
        "name": view.name,
        "nodes": positions.shape[1],
        "face_nodes": faces.shape[1],
        "counts": view.surface.counts,
        "origin": low.tolist(),
        "step": step.tolist(),
        "top": top,
        "colours": [to_hex(colour) for colour in colormaps[_COLOURS](np.linspace(0.0, 1.0, _SAMPLES))],
        "weights": weights.tolist(),
        "triangles": triangles.tolist(),
        "rings": [asdict(ring) for ring in view.rings],
        "states": [
            {
                "kpa": state.pressure_kpa,
                "tip_mm": None if math.isnan(state.tip_mm) else state.tip_mm,
                "largest": float(state.stretch[_soft_nodes(view)].max()),
                "rings": np.round(state.rings, 6).tolist(),
            }
            for state in view.states
        ],
        "data": base64.b64encode(zlib.compress(b"".join(a.tobytes() for a in arrays), 9)).decode("ascii"),
    }


def _soft_nodes(view: View) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Nodes of the faces that are not rigid."""
    return np.unique(view.surface.faces[~view.surface.rigid])
