"""Distances between parts of a deformed meridian outline, and between it and rings: before first touch, and after.

A gap is measured along the outward normal of the outline to the nearest part of it that faces it. It is signed:
negative once one part has gone into the other, so a path shows when they first touched. A bend that nothing
faces has no gap (infinity). Outlines are polylines through all nodes of the quadratic cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from meshes.solid import FACETS, FloatArray, IntArray, SolidMesh


@dataclass(frozen=True)
class Outline:
    """A stretch of free surface of a meridian mesh.

    Attributes
    ----------
    nodes
        Nodes in order along the surface, corner, mid-edge, corner, ..., shape (2 m + 1,).
    sources
        Places in ``nodes`` at which gaps are measured, shape (s,).
    side
        +1 or -1: the outward normal is ``side`` times the tangent turned by a quarter to the left.
    """

    nodes: IntArray
    sources: IntArray
    side: float


@dataclass(frozen=True)
class Gap:
    """The smallest gap and where it is.

    Attributes
    ----------
    gap_mm
        Smallest signed gap, mm; infinite if nothing faces anything.
    at_mm
        Deformed (r, z) of the place, mm, shape (2,).
    """

    gap_mm: float
    at_mm: FloatArray


NO_GAP = Gap(np.inf, np.full(2, np.nan))


def outlines(mesh: SolidMesh) -> tuple[Outline, ...]:
    """The cavity side and the outside of a meridian mesh, each in order.

    Gaps are not measured from bonded edges: what covers them is another body.
    """
    found = []
    for tags in (("cavity",), ("outer", "bond", "tip")):
        keep = np.isin(mesh.facet_tags, [FACETS[tag] for tag in tags])
        edges, covered = mesh.facets[keep], mesh.facet_tags[keep] == FACETS["bond"]
        corners = _chain(edges)
        nodes = np.empty(2 * len(corners) - 1, dtype=np.int64)
        nodes[::2] = corners
        nodes[1::2] = _mid_nodes(mesh, corners)
        sources = np.flatnonzero(~np.isin(nodes, np.unique(edges[covered])))
        sources = sources[sources % 2 == 0]
        found.append(Outline(nodes, sources, _outward(mesh, nodes)))
    return tuple(found)


def smallest_gap(outline: Outline, points: FloatArray, depth_mm: float, reach_mm: float) -> Gap:
    """Smallest signed gap of an outline to itself.

    Parameters
    ----------
    outline
        From `outlines`.
    points
        Deformed (r, z) of all nodes of the mesh, shape (n, 2), mm.
    depth_mm
        How deep one part may have gone into the other and still be recognised; less than the wall, mm.
    reach_mm
        Gaps wider than this are not looked for.
    """
    from scipy.spatial import cKDTree  # takes a tenth of a second to import, which plans would pay too

    line = points[outline.nodes]
    tangent = np.gradient(line, axis=0)
    normal = outline.side * np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    start, step = line[:-1], np.diff(line, axis=0)
    facing = outline.side * np.column_stack([-step[:, 1], step[:, 0]])  # outward normals of the segments
    near = cKDTree(start + 0.5 * step).query_ball_point(line[outline.sources], reach_mm)
    source = np.repeat(outline.sources, [len(found) for found in near])
    segment = np.fromiter(chain.from_iterable(near), dtype=np.int64, count=len(source))
    elsewhere = (segment < source - 1) | (segment > source)
    source, segment = source[elsewhere], segment[elsewhere]

    # origin + g ray = start + s step
    ray, edge, between = normal[source], step[segment], start[segment] - line[source]
    cross = _cross(ray, edge)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance, along = _cross(between, edge) / cross, _cross(between, ray) / cross
    opposed = np.einsum("ij,ij->i", ray, facing[segment]) < 0.0
    hit = opposed & (along >= 0.0) & (along <= 1.0) & (distance > -depth_mm)
    if not hit.any():
        return NO_GAP
    nearest = int(np.argmin(np.where(hit, distance, np.inf)))
    return Gap(float(distance[nearest]), line[source[nearest]])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def smallest_gap_to_ring(points: FloatArray, ring: FloatArray) -> Gap:
    """Smallest signed distance of points to a ring's section.

    Parameters
    ----------
    points
        Deformed (r, z) of free surface nodes, shape (m, 2), mm.
    ring
        Corners of the section's closed polygon in order, where the ring is now, shape (k, 2), mm.

    Returns
    -------
    Gap
        Negative inside the section.
    """
    if not len(points):
        return NO_GAP
    start, step = ring, np.roll(ring, -1, axis=0) - ring
    long = step.any(axis=1)  # a ring that is rounded over its whole height has two corners in one
    start, step = start[long], step[long]
    between = points[:, None] - start[None]
    share = np.clip(np.einsum("mkd,kd->mk", between, step) / np.einsum("kd,kd->k", step, step), 0.0, 1.0)
    distance = np.linalg.norm(between - share[..., None] * step, axis=-1).min(axis=1)
    # even-odd rule along a ray of constant z
    end = start + step
    crosses = (start[None, :, 1] > points[:, None, 1]) != (end[None, :, 1] > points[:, None, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        r_at = start[:, 0] + (points[:, None, 1] - start[:, 1]) / step[:, 1] * step[:, 0]
    inside = (crosses & (points[:, None, 0] < r_at)).sum(axis=1) % 2 == 1
    signed = np.where(inside, -distance, distance)
    nearest = int(np.argmin(signed))
    return Gap(float(signed[nearest]), points[nearest])


def ring_section(radius_mm: float, centre_mm: float, width_mm: float, height_mm: float, edge_mm: float) -> FloatArray:
    """Polygon of a ring's section on a seat: a rectangle with its two outer edges rounded.

    Parameters
    ----------
    radius_mm
        Inner radius, mm.
    centre_mm
        Axial position of its middle, mm.
    width_mm, height_mm, edge_mm
        Axial width, radial height and edge radius, mm.

    Returns
    -------
    ndarray
        Shape (k, 2): (r, z), mm.
    """
    turn = np.linspace(0.0, 0.5 * np.pi, 9 if edge_mm > 0.0 else 1)
    top, half = radius_mm + height_mm - edge_mm, 0.5 * width_mm - edge_mm
    upper = np.column_stack([top + edge_mm * np.sin(turn), half + edge_mm * np.cos(turn)])
    lower = upper[::-1] * np.array([1.0, -1.0])
    ends = np.array([[radius_mm, 0.5 * width_mm]]), np.array([[radius_mm, -0.5 * width_mm]])
    return np.vstack([ends[0], upper, lower, ends[1]]) + np.array([0.0, centre_mm])


def _chain(edges: IntArray) -> IntArray:
    """Nodes of an open chain of edges in order, from the end with the smaller number."""
    order: dict[int, list[int]] = {int(n): [] for n in np.unique(edges)}
    for a, b in edges.tolist():
        order[a].append(b)
        order[b].append(a)
    here = min(n for n, others in order.items() if len(others) == 1)
    ordered, last = [here], -1
    while True:
        onward = [n for n in order[here] if n != last]
        if not onward:
            return np.array(ordered, dtype=np.int64)
        last, here = here, onward[0]
        ordered.append(here)


def _mid_nodes(mesh: SolidMesh, corners: IntArray) -> IntArray:
    """Mid-edge node between each corner and the next."""
    known: dict[tuple[int, int], int] = {}
    for k, (i, j) in enumerate(mesh.cell.facets):
        ends = np.sort(mesh.cells[:, [i, j]], axis=1)
        mids = mesh.cells[:, mesh.cell.corners + k]
        known.update(zip(map(tuple, ends.tolist()), mids.tolist(), strict=True))
    pairs = np.sort(np.column_stack([corners[:-1], corners[1:]]), axis=1)
    return np.array([known[tuple(pair)] for pair in pairs.tolist()], dtype=np.int64)


def _outward(mesh: SolidMesh, nodes: IntArray) -> float:
    """Side on which the solid is not, seen along the outline: from the cell at its first edge."""
    corners = mesh.cells[:, : mesh.cell.corners]
    first = np.isin(corners, nodes[[0, 2]]).sum(axis=1) == 2
    centre = mesh.points[corners[first][0]].mean(axis=0)
    along = mesh.points[nodes[2]] - mesh.points[nodes[0]]
    inward = centre - mesh.points[nodes[0]]
    return -1.0 if along[0] * inward[1] - along[1] * inward[0] > 0.0 else 1.0
