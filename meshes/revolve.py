"""The 3D body: a meridian of quadratic triangles swept round the axis and split into quadratic tetrahedra.

Every prism (triangle times one step round) is cut into three tetrahedra by the order of its meridian nodes,
so neighbours agree on the diagonals. Every second layer is the mirror image of its neighbour, so that the
mesh has mirror planes and prefers no sense of twist. Prisms that touch the axis lose their flat tetrahedra.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshes.errors import GeometryError
from meshes.quality import jacobians
from meshes.solid import FACETS, TETRAHEDRON_EDGES, TRIANGLE_EDGES, FloatArray, IntArray, SolidMesh

# Corners of the three tetrahedra of a prism: (meridian corner in ascending order, 0 = this side, 1 = that).
_PRISM_TETS = (
    ((0, 0), (1, 0), (2, 0), (2, 1)),
    ((0, 0), (1, 0), (1, 1), (2, 1)),
    ((0, 0), (0, 1), (1, 1), (2, 1)),
)
_QUAD_TRIANGLES = (((0, 0), (1, 0), (1, 1)), ((0, 0), (0, 1), (1, 1)))


def revolve(meridian: SolidMesh, around: int) -> SolidMesh:
    """Sweep a meridian mesh round the z axis.

    Parameters
    ----------
    meridian
        Quadratic triangles in (r, z).
    around
        Number of cells round the circumference, even and at least 4.

    Returns
    -------
    SolidMesh
        Curved ten-node tetrahedra; all nodes lie on the surface of revolution through the meridian's nodes.

    Raises
    ------
    GeometryError
        If ``around`` is odd or less than 4.
    """
    if around < 4 or around % 2:
        raise GeometryError(f"cells round the circumference = {around}: must be even and at least 4")
    steps = 2 * around  # half steps: corners at even ones, mid-edge nodes also at odd ones
    on_axis = meridian.points[:, 0] == 0.0
    edge_mid = _edge_table(meridian)

    def node(m: IntArray, half_step: IntArray) -> IntArray:
        """Lattice number of meridian node m at a half step; all half steps coincide on the axis."""
        return m * steps + np.where(on_axis[m], 0, half_step % steps)

    def middle(m_a: IntArray, h_a: IntArray, m_b: IntArray, h_b: IntArray) -> IntArray:
        m = np.where(m_a == m_b, m_a, edge_mid(m_a, m_b))
        h = np.where(on_axis[m_a], h_b, np.where(on_axis[m_b], h_a, (h_a + h_b) // 2))
        return node(m, h)

    layer = np.arange(around)
    this_side = 2 * layer + 2 * (layer % 2)
    that_side = 2 * layer + 2 * ((layer + 1) % 2)

    order = np.sort(meridian.cells[:, :3], axis=1)
    cells, regions, layers = [], [], []
    for corners in _PRISM_TETS:
        m = np.stack([np.repeat(order[:, k], around) for k, _ in corners], axis=1)
        h = np.stack([np.tile(that_side if s else this_side, len(order)) for _, s in corners], axis=1)
        corner_nodes = node(m, h)
        mids = np.stack([middle(m[:, i], h[:, i], m[:, j], h[:, j]) for i, j in TETRAHEDRON_EDGES], axis=1)
        ordered = np.sort(corner_nodes, axis=1)
        solid = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)  # on the axis corners of a prism coincide
        cells.append(np.hstack([corner_nodes, mids])[solid])
        regions.append(np.repeat(meridian.regions, around)[solid])
        layers.append(np.tile(layer, len(order))[solid])

    facets, tags, bodies = _sweep_facets(meridian, node, this_side, that_side)
    lattice_cells = np.vstack(cells)
    used, back = np.unique(lattice_cells, return_inverse=True)
    m_used, h_used = used // steps, used % steps
    angle = h_used * (np.pi / around)
    r, z = meridian.points[m_used].T
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    _refuse_folded(points, back.reshape(lattice_cells.shape)[np.concatenate(layers) < 2], around)
    tip = int(np.searchsorted(used, meridian.tip_centre_node * steps))
    return SolidMesh(
        points=points,
        cells=back.reshape(lattice_cells.shape).astype(np.int64),
        regions=np.concatenate(regions),
        facets=np.sort(np.searchsorted(used, facets), axis=1),
        facet_tags=tags,
        facet_bodies=bodies,
        tip_centre_node=tip,
        meridian_node=m_used,
        angle_rad=angle,
    )


def _refuse_folded(points: FloatArray, cells: IntArray, around: int) -> None:
    """Refuse folded cells; two neighbouring layers stand for all."""
    signed = jacobians(points, cells)
    signed = signed * np.sign(signed.mean(axis=1, keepdims=True))
    if signed.min() <= 0.0:
        worst = cells[int(np.argmin(signed.min(axis=1)))]
        x, y, z = points[worst].mean(axis=0)
        raise GeometryError(
            f"{around} cells round the circumference are too few for this meridian: a cell at r = "
            f"{float(np.hypot(x, y)):.3g}, z = {z:.3g} mm folds over itself; take more"
        )


def _edge_table(meridian: SolidMesh) -> Callable[[IntArray, IntArray], IntArray]:
    """Function giving the mid-edge node of a pair of meridian corners."""
    n = len(meridian.points)
    keys, mids = [], []
    for k, (i, j) in enumerate(TRIANGLE_EDGES):
        a, b = meridian.cells[:, i], meridian.cells[:, j]
        keys.append(np.minimum(a, b) * n + np.maximum(a, b))
        mids.append(meridian.cells[:, 3 + k])
    key, first = np.unique(np.concatenate(keys), return_index=True)
    mid = np.concatenate(mids)[first]

    def edge_mid(a: IntArray, b: IntArray) -> IntArray:
        wanted = np.minimum(a, b) * n + np.maximum(a, b)
        return mid[np.minimum(np.searchsorted(key, wanted), len(key) - 1)]

    return edge_mid


def _sweep_facets(
    meridian: SolidMesh,
    node: Callable[[IntArray, IntArray], IntArray],
    this_side: IntArray,
    that_side: IntArray,
) -> tuple[IntArray, IntArray, IntArray]:
    """Triangles of the swept boundary edges in lattice numbers, with their tags and bodies."""
    keep = meridian.facet_tags != FACETS["axis"]
    edges = meridian.facets[keep]
    around = len(this_side)
    facets, tags, bodies = [], [], []
    for corners in _QUAD_TRIANGLES:
        m = np.stack([np.repeat(edges[:, k], around) for k, _ in corners], axis=1)
        h = np.stack([np.tile(that_side if s else this_side, len(edges)) for _, s in corners], axis=1)
        triangle = node(m, h)
        solid = (
            (triangle[:, 0] != triangle[:, 1]) & (triangle[:, 1] != triangle[:, 2]) & (triangle[:, 0] != triangle[:, 2])
        )
        facets.append(triangle[solid])
        tags.append(np.repeat(meridian.facet_tags[keep], around)[solid])
        bodies.append(np.repeat(meridian.facet_bodies[keep], around)[solid])
    return np.vstack(facets), np.concatenate(tags), np.concatenate(bodies)


def revolve_vector(meridian_values: FloatArray, mesh: SolidMesh) -> FloatArray:
    """Carry (radial, axial) values on meridian nodes over to (x, y, z) on a revolved mesh.

    Parameters
    ----------
    meridian_values
        Shape (meridian nodes, 2).
    mesh
        A mesh made by `revolve` or `meshes.sweep.revolve_hexahedra` from that meridian.

    Returns
    -------
    ndarray
        Shape (nodes, 3).
    """
    radial, axial = revolve_scalar(meridian_values, mesh).T
    return np.column_stack([radial * np.cos(mesh.angle_rad), radial * np.sin(mesh.angle_rad), axial])


def revolve_scalar(meridian_values: FloatArray, mesh: SolidMesh) -> FloatArray:
    """Carry values on meridian nodes, shape (meridian nodes, ...), over to the nodes of a revolved mesh."""
    values = meridian_values[mesh.meridian_node]
    return np.einsum("nk...,nk->n...", values, mesh.meridian_weight) if mesh.meridian_weight.size else values
