"""The peers' problem as an input deck of FEBio 4: FEBio is in no package registry, so its users run it themselves.

Usage: python -m studies.peers.febio_deck MESH.npz OUT.feb, with a mesh of tetrahedra; mm, N, MPa.
Its tip is the mean of uz over the node set ``tip``, weighted by the weights written beside the deck.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

# FEBio's ten-node tetrahedron and six-node triangle in basix order.
_TET10, _TRI6 = [0, 1, 2, 3, 9, 6, 8, 7, 5, 4], [0, 1, 2, 5, 3, 4]
# FEBio needs a compressible law: its tetrahedra with this bulk modulus over shear modulus.
KAPPA_OVER_MU = 1000.0


def write_febio_deck(mesh_file: Path, deck: Path) -> None:
    """Write the deck of a mesh made by `studies.peers.exchange.write_peer_mesh`.

    Raises
    ------
    ValueError
        If it is not a mesh of tetrahedra.
    """
    data = np.load(mesh_file)
    if data["cells"].shape[1] != 10:
        raise ValueError(f"{mesh_file}: cells have {data['cells'].shape[1]} nodes; the deck takes ten-node tetrahedra")
    root = ET.Element("febio_spec", version="4.0")
    ET.SubElement(root, "Module", type="solid")
    control = _with(root, "Control", analysis="STATIC", time_steps="10", step_size="0.1")
    solver = {"symmetric_stiffness": "symmetric", "max_refs": "15", "dtol": "1e-6", "etol": "1e-8"}
    _with(control, "solver", {"type": "solid"}, **solver)
    _with(control, "time_stepper", {"type": "default"}, dtmin="1e-5", dtmax="0.25", max_retries="10", opt_iter="8")

    c1, c2, c3 = map(float, data["yeoh_mpa"])
    young, poisson = map(float, data["ring_mpa_nu"])
    materials = ET.SubElement(root, "Material")
    bulk = KAPPA_OVER_MU * 2.0 * c1
    law = {"c1": c1, "c2": c2, "c3": c3, "c4": 0.0, "c5": 0.0, "c6": 0.0, "k": bulk}
    _material(materials, 1, "silicone", "Yeoh", law)
    _material(materials, 2, "ring", "neo-Hookean", {"E": young, "v": poisson})

    mesh = ET.SubElement(root, "Mesh")
    nodes = ET.SubElement(mesh, "Nodes", name="all")
    for number, place in enumerate(data["points"], start=1):
        ET.SubElement(nodes, "node", id=str(number)).text = ",".join(f"{v:.12g}" for v in place)
    for region, name in ((1, "silicone"), (2, "ring")):
        elements = ET.SubElement(mesh, "Elements", type="tet10", name=name)
        for k in np.flatnonzero(data["regions"] == region):
            ET.SubElement(elements, "elem", id=str(k + 1)).text = _list(data["cells"][k, _TET10])
    for name, members in (("clamped", np.unique(data["clamped_facets"])), ("tip", data["tip_nodes"])):
        ET.SubElement(mesh, "NodeSet", name=name).text = _list(members)
    surface = ET.SubElement(mesh, "Surface", name="cavity")
    for k, facet in enumerate(data["cavity_facets"][:, _TRI6], start=1):
        ET.SubElement(surface, "tri6", id=str(k)).text = _list(facet)
    domains = ET.SubElement(root, "MeshDomains")
    for name in ("silicone", "ring"):
        ET.SubElement(domains, "SolidDomain", name=name, mat=name)

    boundary = ET.SubElement(root, "Boundary")
    fixed = {"name": "clamped", "node_set": "clamped", "type": "zero displacement"}
    _with(boundary, "bc", fixed, x_dof="1", y_dof="1", z_dof="1")
    load = ET.SubElement(ET.SubElement(root, "Loads"), "surface_load", surface="cavity", type="pressure")
    ET.SubElement(load, "pressure", lc="1").text = f"{float(data['pressure_mpa']):.12g}"
    ET.SubElement(load, "linear").text = "0"  # follows the surface
    curve = _with(ET.SubElement(root, "LoadData"), "load_controller", {"id": "1", "type": "loadcurve"})
    ET.SubElement(curve, "interpolate").text = "LINEAR"
    _with(curve, "points", {}, ("pt", "0,0"), ("pt", "1,1"))
    log = ET.SubElement(ET.SubElement(root, "Output"), "logfile")
    ET.SubElement(log, "node_data", data="uz", file="tip.txt", node_set="tip")
    ET.indent(root, " ")
    ET.ElementTree(root).write(deck, encoding="utf-8", xml_declaration=True)
    weights = np.column_stack([data["tip_nodes"] + 1, data["tip_weights"]])
    np.savetxt(deck.with_suffix(".weights.txt"), weights, fmt=["%d", "%.12g"], header="node weight: tip_mm = sum w uz")


def _with(
    parent: ET.Element, tag: str, attributes: dict[str, str] | None = None, *pairs: tuple[str, str], **texts: str
) -> ET.Element:
    """A child element with children that hold texts."""
    child = ET.SubElement(parent, tag, attributes or {})
    for name, text in [*pairs, *texts.items()]:
        ET.SubElement(child, name).text = text
    return child


def _material(parent: ET.Element, number: int, name: str, kind: str, constants: dict[str, float]) -> None:
    texts = {key: f"{value:.12g}" for key, value in constants.items()}
    _with(parent, "material", {"id": str(number), "name": name, "type": kind}, **texts)


def _list(nodes: np.ndarray) -> str:
    return ",".join(str(int(n) + 1) for n in nodes)


if __name__ == "__main__":
    write_febio_deck(Path(sys.argv[1]), Path(sys.argv[2]))
