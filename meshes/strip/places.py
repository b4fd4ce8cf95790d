"""Places of a strip found in the cells of a meridian: from the nodes of one level to those of another."""

from __future__ import annotations

import numpy as np

from meshes.cells import FloatArray, IntArray
from meshes.errors import MeshError
from meshes.solid import SolidMesh

# Round-off of strip coordinates, and of places in a reference cell.
_NEAR = 1e-9
# Of a bilinear map whose sides are not far from parallel, to round-off.
_NEWTON_STEPS = 8


def interpolation(mesh: SolidMesh, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """How to read off what a meridian's nodes have at other places of its strip, such as the nodes of a finer level.

    Parameters
    ----------
    mesh, at
        As for `cells_at`.

    Returns
    -------
    nodes, weights
        Nodes of the cell that each place is in, and their weights there, shape (p, nodes of a cell) both.
    """
    cells, reference = cells_at(mesh, at)
    return mesh.cells[cells], mesh.cell.shape(reference)[0]


def cells_at(mesh: SolidMesh, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """Which cells of a meridian places of its strip are in; between cells, one of them.

    Parameters
    ----------
    mesh
        A meridian with strip coordinates.
    at
        Strip coordinates, shape (p, 2).

    Returns
    -------
    cells, reference
        Numbers of the cells, shape (p,), and the places in their reference cells, shape (p, 2).

    Raises
    ------
    MeshError
        If a place is in no cell.
    """
    in_wall = np.flatnonzero((mesh.cells < len(mesh.strip)).all(axis=1))  # not those of meshed rings
    corners = mesh.strip[mesh.cells[in_wall]]
    first = np.floor(corners.mean(axis=1)[:, 0])  # no cell reaches beyond an interval of the coarsest level
    cells, found = np.full(len(at), -1), np.zeros((len(at), 2))
    for interval in np.unique(first):
        places = np.flatnonzero((at[:, 0] >= interval) & (at[:, 0] <= interval + 1.0) & (cells < 0))
        own = np.flatnonzero(first == interval)
        low, high = corners[own].min(axis=1) - _NEAR, corners[own].max(axis=1) + _NEAR
        place, cell = np.nonzero(((at[places, None] >= low) & (at[places, None] <= high)).all(axis=2))
        place, cell = places[place], own[cell]
        reference = np.tile(mesh.cell.rule[0].mean(axis=0), (len(place), 1))
        for _ in range(_NEWTON_STEPS):
            value, slope = mesh.cell.shape(reference)
            away = at[place] - np.einsum("pk,pkd->pd", value, corners[cell])
            matrix = np.einsum("pkd,pkr->pdr", corners[cell], slope)
            reference = reference + np.linalg.solve(matrix, away[..., None])[..., 0]
        inside = (reference > -_NEAR).all(axis=1) & (reference < 1.0 + _NEAR).all(axis=1)
        if mesh.cell.name == "triangle":
            inside &= reference.sum(axis=1) < 1.0 + _NEAR
        cells[place[inside]], found[place[inside]] = in_wall[cell[inside]], reference[inside]
    if (cells < 0).any():
        s, t = at[np.flatnonzero(cells < 0)[0]]
        raise MeshError(f"no cell of the meridian's strip is at s = {s:g}, t = {t:g}")
    return cells, found
