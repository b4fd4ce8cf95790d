"""Meshes that nobody would choose: nodes shaken at random, rows of nodes pushed to and fro. The solver judges them."""

from __future__ import annotations

import dataclasses

import numpy as np

from meshes.cells import QUADRILATERAL_NODES
from meshes.solid import FloatArray, SolidMesh


def shaken(mesh: SolidMesh, share: float, seed: int) -> SolidMesh:
    """A meridian whose inner corners are moved at random; other inner nodes follow the corners of their cells.

    Parameters
    ----------
    mesh
        Triangles or quadrilaterals.
    share
        Largest move along r and z, as a share of the shortest edge at the corner.
    seed
        Of the random numbers.
    """
    moves = np.random.default_rng(seed).uniform(-share, share, mesh.points.shape)
    return _moved(mesh, moves * _shortest_edge_mm(mesh)[:, None])


def zigzag(mesh: SolidMesh, share: float, polar: bool) -> SolidMesh:
    """A meridian of a tube or (``polar``) a sphere whose cells become trapezoids that alternate.

    Parameters
    ----------
    mesh
        Triangles or quadrilaterals in rows and layers.
    share
        Move of the inner corners along their row, as a share of the shortest edge at the corner.
    polar
        Rows go round instead of along z.
    """
    r, z = mesh.points.T
    across, along = (np.hypot(r, z), np.arctan2(z, r)) if polar else (r, z)
    ranks = [np.unique(np.round(a[mesh.corners], 9), return_inverse=True)[1] for a in (across, along)]
    moves = np.zeros_like(mesh.points)
    sign = np.where((ranks[0] + ranks[1]) % 2 == 0, 1.0, -1.0)
    direction = np.column_stack([-np.sin(along), np.cos(along)]) if polar else np.array([[0.0, 1.0]])
    moves[mesh.corners] = sign[:, None] * np.broadcast_to(direction, mesh.points.shape)[mesh.corners]
    return _moved(mesh, share * moves * _shortest_edge_mm(mesh)[:, None])


def _shortest_edge_mm(mesh: SolidMesh) -> FloatArray:
    """Shortest distance between a corner and another one of its cells, mm; zero at other nodes."""
    corners = mesh.cells[:, : mesh.cell.corners]
    out = np.full(len(mesh.points), np.inf)
    for i in range(mesh.cell.corners):
        for j in range(i):
            length = np.linalg.norm(mesh.points[corners[:, i]] - mesh.points[corners[:, j]], axis=1)
            np.minimum.at(out, corners[:, i], length)
            np.minimum.at(out, corners[:, j], length)
    return np.where(np.isfinite(out), out, 0.0)


def _moved(mesh: SolidMesh, moves: FloatArray) -> SolidMesh:
    """The mesh with its inner corners moved; nodes between corners follow linearly, the boundary stays."""
    moves = moves.copy()
    moves[np.unique(mesh.facets)] = 0.0
    if mesh.cell.corners == 4:
        s, t = 0.5 * QUADRILATERAL_NODES.T
        weights = np.stack([(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t], axis=1)
    else:
        weights = np.vstack([np.eye(3), [[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]])
    every = np.zeros_like(moves)
    every[mesh.cells] = np.einsum("nk,cki->cni", weights, moves[mesh.cells[:, : mesh.cell.corners]])
    return dataclasses.replace(mesh, points=mesh.points + every)
