"""Scenes of users' meshes, each with the same body as a tube or sphere of this program's own, whose bore is known."""

from __future__ import annotations

from typing import Final

from hypothesis import strategies as st

from meshes.bodies import tube_meridian
from meshes.cells import CellKind
from meshes.solid import FACETS, SolidMesh
from studies.fuzz.scenes import Contents, asks, laws, loads, modulus_of, size
from studies.results.provenance import ROOT

FILE: Final = "body.msh"
# Radii of scenes/exact/octant.msh, mm, and what is asked of both bodies: the bore moves farthest.
OCTANT_MM: Final = (5.0, 7.0)
MOVES_MOST, BORE = "displacement_max_mm", "bore_mm"
# By nodes of a cell: gmsh's number of the kind, and our nodes in its order.
_GMSH: Final = {6: (9, (0, 1, 2, 5, 3, 4)), 9: (10, (0, 1, 3, 2, 4, 6, 7, 5, 8))}


def gmsh_file(mesh: SolidMesh) -> bytes:
    """A meridian as a gmsh file of version 2.2."""
    kind, order = _GMSH[mesh.cells.shape[1]]
    names = {int(tag): name for name, tag in FACETS.items() if tag in mesh.facet_tags}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", f"{len(names) + 1}"]
    lines += [f'1 {tag} "{name}"' for tag, name in names.items()] + ['2 99 "elastomer"', "$EndPhysicalNames"]
    lines += ["$Nodes", f"{len(mesh.points)}"]
    lines += [f"{k} {r:.12g} {z:.12g} 0" for k, (r, z) in enumerate(mesh.points.tolist(), 1)]
    elements = [
        f"1 2 {tag} {tag} {a + 1} {b + 1}" for (a, b), tag in zip(mesh.facets.tolist(), mesh.facet_tags, strict=True)
    ]
    elements += [f"{kind} 2 99 99 " + " ".join(str(cell[k] + 1) for k in order) for cell in mesh.cells.tolist()]
    lines += ["$EndNodes", "$Elements", f"{len(elements)}", *(f"{k} {text}" for k, text in enumerate(elements, 1))]
    return "\n".join([*lines, "$EndElements", ""]).encode()


@st.composite
def meshes(draw: st.DrawFn) -> tuple[Contents, bytes, Contents]:
    """A scene of a user's mesh, the file, and the same body as a kind of its own."""
    material = draw(laws())
    load: Contents = {"pressure_kpa": draw(loads(0.4 * modulus_of(material), 0.02, 1.0))}
    if draw(st.integers(1, 3)) == 1:
        inner, outer = OCTANT_MM
        file = (ROOT / "scenes" / "exact" / "octant.msh").read_bytes()
        twin: Contents = {"kind": "sphere", "inner_radius_mm": inner, "outer_radius_mm": outer}
    else:
        inner = draw(size(1.0, 20.0))
        outer, length = round(inner * (1.0 + draw(size(0.1, 0.8))), 4), round(inner * draw(size(0.6, 1.5)), 4)
        cells: CellKind = draw(st.sampled_from(["triangles", "triangles", "quadrilaterals"]))
        along, through = draw(st.integers(2, 4)), draw(st.integers(3, 5))
        file = gmsh_file(tube_meridian(inner, outer, length, along, through, cells))
        twin = {"kind": "tube", "inner_radius_mm": inner, "outer_radius_mm": outer, "length_mm": length}
    ask = draw(asks([MOVES_MOST]))
    geometry: Contents = {"kind": "mesh", "file": FILE, "scale": 1.0}
    same = {"material": material, "load": load}
    mine = {"geometry": geometry, **same, "ask": {**ask, "quantities": [MOVES_MOST]}}
    return mine, file, {"geometry": twin, **same, "ask": {"quantities": [BORE], "tolerance_percent": 0.1}}
