"""Surfaces of a user's mesh that move as rigid bodies: what symmetry leaves them, and the hole that a tip closes."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshes.cells import FloatArray, IntArray
from meshes.errors import MeshError
from meshes.solid import FACETS, SolidMesh
from meshes.surface import surface_weights
from meshes.users.surfaces import cavity_rim

# Planes across each axis, and the motions of a body that touches one: it neither leaves it nor turns out of it.
_PLANES = {
    "symmetry_x": (0, 4, 5),
    "symmetry_y": (1, 3, 5),
    "symmetry_z": (2, 3, 4),
    "bottom": (2, 3, 4),
    "top": (2, 3, 4),
}
# A rim is level, and centred on the axis, to this part of the hole's size.
LEVEL, CENTRED = 1e-4, 1e-2


@dataclass(frozen=True)
class Rim:
    """The edge at which a cavity ends on a surface: how many edges it has, and the area within, mm^2."""

    edges: int
    area_mm2: float


def body_weights(mesh: SolidMesh, body: int) -> FloatArray:
    """As `meshes.surface.surface_weights`, of the surface of a rigid body."""
    tags = np.where(mesh.facet_bodies == body, FACETS["bond"], 0)
    return surface_weights(dataclasses.replace(mesh, facet_tags=tags), "bond")


def held_by_symmetry(mesh: SolidMesh, body: int) -> NDArray[np.bool_]:
    """Which of a body's six motions, translations first, planes of symmetry that it touches hold, shape (6,)."""
    mine, held = np.unique(mesh.facets[mesh.facet_bodies == body]), np.zeros(6, dtype=bool)
    for name, motions in _PLANES.items():
        if np.isin(mine, mesh.facets[mesh.facet_tags == FACETS[name]]).any():
            held[list(motions)] = True
    return held


def rim_on(mesh: SolidMesh, surface: IntArray) -> Rim:
    """Where the cavity ends on a surface, given by the corners of its facets.

    Raises
    ------
    MeshError
        If the rim is not in one plane z = const, or not centred on the z axis: a plate that turns would sweep more than
        is known of it.
    """
    nodes, ends = np.unique(surface), cavity_rim(mesh)
    ends = ends[np.isin(ends, nodes).all(axis=1)]
    if mesh.dimension == 2:
        at = mesh.points[ends[:, 0]]
        at = at[at[:, 0] > 0.0]
        return Rim(len(at), float(np.pi * np.sum(at[:, 0] ** 2)))
    here = {tuple(pair) for pair in ends.tolist()}
    edges = [edge for edge in _edges(mesh, nodes) if (min(edge[0], edge[2]), max(edge[0], edge[2])) in here]
    if not edges:
        return Rim(0, 0.0)
    chains = _chains(edges)
    area = 0.0
    for chain in chains:
        at = mesh.points[chain]
        size = float(np.linalg.norm(np.ptp(at, axis=0)))
        if np.ptp(at[:, 2]) > LEVEL * size:
            raise MeshError(
                f"the cavity's rim on the tip goes from z = {at[:, 2].min():g} to {at[:, 2].max():g} mm: a rigid tip "
                "closes a hole in a plane z = const: cut it so, or close the cavity by its own surface"
            )
        x, y = at[:, 0], at[:, 1]
        a, b, c = (np.stack([x[k : len(x) - 2 + k : 2], y[k : len(x) - 2 + k : 2]]) for k in range(3))
        area += abs(float(np.sum(4.0 * _cross(a, b) + 4.0 * _cross(b, c) - _cross(a, c)))) / 6.0
        if chain[0] == chain[-1]:
            pieces = _cross(at[:-1, :2].T, at[1:, :2].T)
            centre = ((at[:-1, :2] + at[1:, :2]) * pieces[:, None]).sum(axis=0) / (3.0 * pieces.sum())
            if np.abs(centre).max() > CENTRED * size:
                raise MeshError(
                    f"the cavity's rim on the tip is centred on x = {centre[0]:.4g}, y = {centre[1]:.4g} mm: a rigid "
                    "tip closes a hole centred on the z axis: move the body there"
                )
    return Rim(len(edges), area)


def _cross(p: FloatArray, q: FloatArray) -> FloatArray:
    return np.asarray(p[0] * q[1] - p[1] * q[0])


def _edges(mesh: SolidMesh, nodes: IntArray) -> list[tuple[int, int, int]]:
    """Edges of cells between nodes: corner, middle, corner; each once."""
    cell, found = mesh.cell, {}
    near = mesh.cells[np.isin(mesh.cells[:, : cell.corners], nodes).sum(axis=1) > 1]
    for i, j in itertools.combinations(range(cell.corners), 2):
        away = np.abs(cell.nodes[i] - cell.nodes[j])
        if cell.corners > 4 and np.count_nonzero(away) > 1:
            continue  # a diagonal
        middle = int(np.argmin(np.abs(cell.nodes - 0.5 * (cell.nodes[i] + cell.nodes[j])).sum(axis=1)))
        ends = near[np.isin(near[:, i], nodes) & np.isin(near[:, j], nodes)]
        for a, m, b in ends[:, [i, middle, j]].tolist():
            found[min(a, b), max(a, b)] = (a, m, b)
    return list(found.values())


def _chains(edges: list[tuple[int, int, int]]) -> list[list[int]]:
    """Edges joined end to end: nodes along each chain, corners and middles in turn; the first is the last of a ring."""
    at: dict[int, list[tuple[int, int, int]]] = {}
    for edge in edges:
        at.setdefault(edge[0], []).append(edge)
        at.setdefault(edge[2], []).append(edge)
    left, chains = set(edges), []
    starts = [n for n, of in at.items() if len(of) == 1]
    while left:
        here = next((n for n in starts if any(edge in left for edge in at[n])), None)
        here = next(iter(sorted(left)))[0] if here is None else here
        chain = [here]
        while ahead := [edge for edge in at[chain[-1]] if edge in left]:
            start, middle, end = ahead[0]
            left.remove(ahead[0])
            chain += [middle, end if start == chain[-1] else start]
        chains.append(chain)
    return chains
