"""The 3D body in hexahedra: a meridian of nine-node quadrilaterals swept round the axis, wholly or by a sector.

All nodes lie on the surface of revolution through the meridian. No cell collapses on the axis: where a meridian
touches it, the innermost columns of quadrilaterals give way to a core. The core is one disc of quadrilaterals per
layer: kites with a corner on the axis, and cells between them and the circle where the sweep takes over. A node of
the disc at a distance of s columns from the axis lies where the meridian's own quadratic cells put s, turned by its
angle, so that displacements are carried to it by the same three weights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES, quadratic_weights
from meshes.errors import GeometryError, MeshError
from meshes.quality import jacobians
from meshes.solid import FACETS, FloatArray, IntArray, SolidMesh

FULL_CIRCLE = 2.0 * math.pi
# Distance of the kites' corners on their sides from the axis, of the core's radius; and how far their outer corners
# go from there towards those of a regular polygon. A polygon leaves flat corners to the cells outside, a circle to
# the kites.
_KITE_SIDE, _KITE_BULGE = 0.5, 0.5
_WIDEST_KITE = math.radians(150.0)

# Local node of a quadrilateral at half steps (a, b); local nodes of a hexahedron by those of its face and half step.
_QUAD_AT = np.empty((3, 3), dtype=np.int64)
_QUAD_AT[QUADRILATERAL_NODES[:, 0], QUADRILATERAL_NODES[:, 1]] = np.arange(9)
_FACE_NODE = _QUAD_AT[HEXAHEDRON_NODES[:, 0], HEXAHEDRON_NODES[:, 1]]
_HALF_STEP = HEXAHEDRON_NODES[:, 2]


def revolve_hexahedra(
    meridian: SolidMesh, around: int, angle_rad: float = FULL_CIRCLE, core_columns: int = 2
) -> SolidMesh:
    """Sweep a meridian of quadrilaterals round the z axis.

    Parameters
    ----------
    meridian
        Nine-node quadrilaterals in (r, z). Cells that touch the axis do so with the far side of their first
        direction, and ``core_columns`` columns of cells follow each other from there along it.
    around
        Number of cells in the angle; even if the meridian touches the axis.
    angle_rad
        The full circle, or the angle of a sector. Its faces are the surfaces ``start`` (at angle 0) and ``end``.
    core_columns
        Columns of cells the core takes the place of.

    Returns
    -------
    SolidMesh
        Curved 27-node hexahedra.

    Raises
    ------
    GeometryError
        If the numbers do not fit or a cell is folded.
    MeshError
        If the meridian is not structured at the axis.
    """
    full = abs(angle_rad - FULL_CIRCLE) < 1e-9
    if meridian.cell.name != "quadrilateral":
        raise MeshError(f"hexahedra need a meridian of quadrilaterals, not of {meridian.cell.name}s")
    if not 0.0 < angle_rad <= FULL_CIRCLE + 1e-9:
        raise GeometryError(f"sector angle = {math.degrees(angle_rad):g} degrees: must be > 0 and at most 360")
    if around < 1 or angle_rad / around > 0.5 * math.pi + 1e-9:
        raise GeometryError(
            f"cells round the circumference = {around} in {math.degrees(angle_rad):g} degrees: must be at least "
            f"{math.ceil(angle_rad / (0.5 * math.pi) - 1e-9)}, a quarter turn each"
        )
    strip = _strip_at_axis(meridian, core_columns)
    lattice = _Lattice(len(meridian.points), 2 * around if full else 2 * around + 1, angle_rad / (2 * around))
    part = _swept(meridian, strip, lattice, around, full)
    nodes = _Nodes(np.empty((0, 3), dtype=np.int64), np.empty((0, 3)), np.empty(0))
    tip = lattice.number(np.array(meridian.tip_centre_node), np.array(0))
    if len(strip.cells):
        disc = _disc(core_columns, around, angle_rad, full)
        core, nodes = _core(meridian, strip, disc, lattice, core_columns)
        part = part.joined(core)
        on_axis = np.flatnonzero(strip.nodes[:, 0] == meridian.tip_centre_node)
        if len(on_axis):
            tip = lattice.first_of_core + disc.centre * len(strip.nodes) + on_axis[0]

    used, back = np.unique(part.cells, return_inverse=True)
    numbers = back.reshape(part.cells.shape).astype(np.int64)
    origin = lattice.origin(used, nodes)
    r, z = np.einsum("nki,nk->in", meridian.points[origin.meridian], origin.weight)
    points = np.column_stack([r * np.cos(origin.angle), r * np.sin(origin.angle), z])
    _refuse_folded(points, numbers, around)
    return SolidMesh(
        points=points,
        cells=numbers,
        regions=part.regions,
        facets=np.sort(np.searchsorted(used, part.facets), axis=1),
        facet_tags=part.tags,
        facet_bodies=part.bodies,
        tip_centre_node=int(np.searchsorted(used, tip)),
        meridian_node=origin.meridian,
        angle_rad=origin.angle,
        meridian_weight=origin.weight,
    )


@dataclass(frozen=True)
class _Nodes:
    """Where nodes come from: meridian nodes and their weights, both (n, 3), and angles (n,)."""

    meridian: IntArray
    weight: FloatArray
    angle: FloatArray


@dataclass(frozen=True)
class _Part:
    """Cells with regions, and boundary facets with tags and bodies; nodes in lattice numbers."""

    cells: IntArray
    regions: IntArray
    facets: IntArray
    tags: IntArray
    bodies: IntArray

    def joined(self, other: _Part) -> _Part:
        """Both together."""
        return _Part(
            np.vstack([self.cells, other.cells]),
            np.concatenate([self.regions, other.regions]),
            np.vstack([self.facets, other.facets]),
            np.concatenate([self.tags, other.tags]),
            np.concatenate([self.bodies, other.bodies]),
        )


@dataclass(frozen=True)
class _Lattice:
    """Numbers of nodes before unused ones are dropped: meridian nodes at half steps, then those of the core.

    Attributes
    ----------
    meridian_nodes
        Their number.
    steps
        Half steps that differ.
    turn_rad
        Angle of a half step.
    """

    meridian_nodes: int
    steps: int
    turn_rad: float

    @property
    def first_of_core(self) -> int:
        """Number of the first node of the core."""
        return self.meridian_nodes * self.steps

    def number(self, m: IntArray, h: IntArray) -> IntArray:
        """Number of meridian node m at half step h."""
        return m * self.steps + h % self.steps

    def origin(self, used: IntArray, core: _Nodes) -> _Nodes:
        """Where the nodes of some numbers come from."""
        inside = used >= self.first_of_core
        mine = used[inside] - self.first_of_core
        nodes = np.repeat(used[:, None] // self.steps, 3, axis=1)
        weight = np.tile([1.0, 0.0, 0.0], (len(used), 1))
        angle = (used % self.steps) * self.turn_rad
        nodes[inside], weight[inside], angle[inside] = core.meridian[mine], core.weight[mine], core.angle[mine]
        return _Nodes(nodes, weight, angle)


def _swept(meridian: SolidMesh, strip: _Strip, lattice: _Lattice, around: int, full: bool) -> _Part:
    """Everything but the core."""
    outside = np.ones(len(meridian.cells), dtype=bool)
    outside[strip.cells.ravel()] = False
    layer = 2 * np.arange(around)
    quads = meridian.cells[outside]
    if (meridian.points[quads, 0] <= 0.0).any():
        raise MeshError("a cell of the meridian touches the axis without being in the columns that end there")
    cells = lattice.number(quads[:, None, _FACE_NODE], layer[None, :, None] + _HALF_STEP).reshape(-1, 27)
    of_core = np.isin(meridian.facets, strip.nodes.ravel()).all(axis=1)
    keep = ~of_core & (meridian.facet_tags != FACETS["axis"])
    ends = np.tile(meridian.facets[keep], 2)  # corners (m0, m1) on both sides of a layer
    facets = [lattice.number(ends[:, None, :], layer[None, :, None] + np.array([0, 0, 2, 2])).reshape(-1, 4)]
    tags = [np.repeat(meridian.facet_tags[keep], around)]
    if not full:
        for name, h in (("start", 0), ("end", 2 * around)):
            facets.append(lattice.number(quads[:, :4], np.array(h)))
            tags.append(np.full(len(quads), FACETS[name]))
    bodies = np.repeat(meridian.facet_bodies[keep], around)
    bodies = np.concatenate([bodies, np.full(sum(map(len, tags)) - len(bodies), -1)])
    return _Part(cells, np.repeat(meridian.regions[outside], around), np.vstack(facets), np.concatenate(tags), bodies)


def _core(meridian: SolidMesh, strip: _Strip, disc: _Disc, lattice: _Lattice, columns: int) -> tuple[_Part, _Nodes]:
    """The core, and where its nodes come from in the order of their numbers."""
    lines = len(strip.nodes)
    # Number of disc node d on line k: new, but for those on the rim, which the sweep has already.
    number = lattice.first_of_core + np.arange(len(disc.points))[:, None] * lines + np.arange(lines)
    number[disc.rim] = lattice.number(strip.nodes[:, -1][None, :], np.arange(len(disc.rim))[:, None])
    s = np.hypot(*disc.points.T)
    column = np.minimum(s.astype(np.int64), columns - 1)
    stations = 2 * column[:, None] + np.arange(3)
    nodes = _Nodes(
        strip.nodes.T[stations].transpose(0, 2, 1).reshape(-1, 3),
        np.repeat(quadratic_weights(s - column), lines, axis=0),
        np.repeat(np.arctan2(disc.points[:, 1], disc.points[:, 0]) % FULL_CIRCLE, lines),
    )
    cells, facets, tags = [], [], []
    for line in strip.lines:
        cells.append(number[disc.cells[:, _FACE_NODE], line[_HALF_STEP]])
        for name, edges in (("start", disc.start), ("end", disc.end)):
            facets.append(number[edges[:, [0, 1, 0, 1]], line[[0, 0, 2, 2]]])
            tags.append(np.full(len(edges), FACETS[name]))
    for k, line_nodes in enumerate(strip.nodes):
        own = np.isin(meridian.facets, line_nodes).all(axis=1)
        if own.any():
            if len(np.unique(meridian.facet_tags[own])) != 1 or (meridian.facet_bodies[own] >= 0).any():
                raise MeshError("the columns of cells at the axis must lie within one named surface")
            facets.append(number[disc.cells[:, :4], k])
            tags.append(np.full(len(disc.cells), meridian.facet_tags[own][0]))
    regions = np.repeat(meridian.regions[strip.cells[:, 0]], len(disc.cells))
    every = np.concatenate(tags)
    return _Part(np.vstack(cells), regions, np.vstack(facets), every, np.full(len(every), -1)), nodes


def _refuse_folded(points: FloatArray, cells: IntArray, around: int) -> None:
    signed = jacobians(points, cells)
    signed = signed * np.sign(signed.mean(axis=1, keepdims=True))
    if signed.min() <= 0.0:
        x, y, z = points[cells[int(np.argmin(signed.min(axis=1)))]].mean(axis=0)
        raise GeometryError(
            f"{around} cells round the circumference are too few for this meridian: a cell at r = "
            f"{float(np.hypot(x, y)):.3g}, z = {z:.3g} mm folds over itself; take more"
        )


@dataclass(frozen=True)
class _Strip:
    """The columns of cells at the axis.

    Attributes
    ----------
    cells
        Rows of cells that start at the axis, shape (rows, columns).
    nodes
        Nodes of each line across the columns, from the axis outwards, shape (lines, 2 columns + 1).
    lines
        The three lines of each row, shape (rows, 3).
    """

    cells: IntArray
    nodes: IntArray
    lines: IntArray


def _strip_at_axis(meridian: SolidMesh, columns: int) -> _Strip:
    """Follow the rows of cells from the axis; empty for a meridian that does not touch it."""
    quads = meridian.cells
    on_axis = meridian.points[:, 0] == 0.0
    rows = np.flatnonzero(on_axis[quads[:, _QUAD_AT[2]]].all(axis=1))
    # the cell whose far side has the given end nodes
    far = {(int(q[1]), int(q[3])): k for k, q in enumerate(quads)}
    chains = []
    for start in rows:
        chain = [int(start)]
        while len(chain) < columns:
            near = quads[chain[-1]]
            following = far.get((int(near[0]), int(near[2])))
            if following is None:
                raise MeshError(f"fewer than {columns} columns of cells lead to the axis")
            chain.append(following)
        chains.append(chain)
    if not chains:
        empty = np.empty((0, 3), dtype=np.int64)
        return _Strip(empty, np.empty((0, 1), dtype=np.int64), empty)
    cells = np.array(chains)
    axis_nodes, lines = np.unique(quads[cells[:, 0]][:, _QUAD_AT[2]], return_inverse=True)
    lines = lines.reshape(len(cells), 3)
    nodes = np.empty((len(axis_nodes), 2 * columns + 1), dtype=np.int64)
    for chain, line in zip(chains, lines, strict=True):
        for c, cell in enumerate(chain):
            for step in range(3):
                nodes[line, 2 * c + step] = quads[cell, _QUAD_AT[2 - step]]
    return _Strip(cells, nodes, lines)


@dataclass(frozen=True)
class _Disc:
    """A disc or a sector of it in quadrilaterals, in units of columns from the axis.

    Attributes
    ----------
    points
        Shape (n, 2).
    cells
        Nine-node quadrilaterals, shape (m, 9).
    rim
        Node on the circle at each half step, shape (half steps,).
    start, end
        Corner nodes of the edges on the sides of a sector, shape (k, 2).
    centre
        Node on the axis.
    """

    points: FloatArray
    cells: IntArray
    rim: IntArray
    start: IntArray
    end: IntArray
    centre: int


def _kites(around: int, angle_rad: float) -> int:
    """Number of kites: each has as many cells along both its outer sides, and its angle is close to 90 degrees."""
    fit = [k for k in range(1, around // 2 + 1) if around % (2 * k) == 0 and angle_rad / k < _WIDEST_KITE]
    if not fit:
        raise GeometryError(
            f"cells round the circumference = {around} in {math.degrees(angle_rad):g} degrees: a mesh that reaches "
            "the axis needs an even number, and at least three pairs in the full circle"
        )
    return min(fit, key=lambda k: abs(math.log(angle_rad / k / (0.5 * math.pi))))


def _disc(columns: int, around: int, angle_rad: float, full: bool) -> _Disc:
    kites = _kites(around, angle_rad)
    half = around // kites  # half steps along each outer side of a kite
    rings = max(1, columns // 2)
    opening = angle_rad / kites
    side = _KITE_SIDE * columns
    tip = side * (1.0 + _KITE_BULGE * (1.0 / math.cos(0.5 * opening) - 1.0))
    patches = []
    for k in range(kites):
        a, b, c = (
            radius * np.array([math.cos(angle), math.sin(angle)])
            for radius, angle in ((side, k * opening), (tip, (k + 0.5) * opening), (side, (k + 1) * opening))
        )
        x = np.linspace(0.0, 1.0, half + 1)
        s, t = x[:, None, None], x[None, :, None]
        kite = s * (1.0 - t) * a + s * t * b + (1.0 - s) * t * c
        patches.append(kite)
        inner = np.vstack([kite[-1, :], kite[-2::-1, -1]])
        angles = k * opening + np.linspace(0.0, opening, 2 * half + 1)
        outer = columns * np.column_stack([np.cos(angles), np.sin(angles)])
        level = np.linspace(0.0, 1.0, 2 * rings + 1)[:, None, None]
        patches.append((1.0 - level) * inner + level * outer)
    # Patches share nodes along their sides; nodes are much farther apart than the rounding.
    every = np.vstack([p.reshape(-1, 2) for p in patches])
    _, first, back = np.unique(np.round(every, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    points = every[first]
    cells, offset = [], 0
    for patch in patches:
        n, m = patch.shape[:2]
        node = back[offset : offset + n * m].reshape(n, m)
        offset += n * m
        cells.append(
            np.stack([node[i : n - 2 + i : 2, j : m - 2 + j : 2].ravel() for i, j in QUADRILATERAL_NODES], axis=1)
        )
    quads = np.vstack(cells)
    angles = angle_rad / (2 * around) * np.arange(2 * around if full else 2 * around + 1)
    ring = columns * np.column_stack([np.cos(angles), np.sin(angles)])
    distance = np.linalg.norm(ring[:, None] - points[None], axis=2)
    rim = distance.argmin(axis=1)
    expected = kites * half * (half + 1 + 4 * rings) + 1 + (0 if full else half + 2 * rings)
    if distance.min(axis=1).max() > 1e-9 * columns or len(points) != expected:
        raise MeshError(f"core of {around} cells round: its patches do not fit together")  # a fault of this program
    start, end = (_edges_along(points, quads, angle) for angle in (0.0, angle_rad))
    none = np.empty((0, 2), dtype=np.int64)
    centre = int(np.argmin(np.hypot(*points.T)))
    return _Disc(points, quads, rim, none if full else start, none if full else end, centre)


def _edges_along(points: FloatArray, quads: IntArray, angle_rad: float) -> IntArray:
    """Corner nodes of the edges on a ray from the centre."""
    ray = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    edges = np.vstack([quads[:, [0, 1, 4]], quads[:, [0, 2, 5]], quads[:, [1, 3, 6]], quads[:, [2, 3, 7]]])
    middle = points[edges[:, 2]]
    on_ray = (middle @ ray > 0.0) & (np.abs(middle[:, 0] * ray[1] - middle[:, 1] * ray[0]) < 1e-9)
    return edges[on_ray, :2]
