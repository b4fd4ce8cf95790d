"""What a gmsh file holds: nodes, elements by kind, physical groups; read by gmsh in a child process.

gmsh runs what a .geo file says and takes the format from a file's ending, so what it is given is a link that ends in
``.msh`` to a file that begins as one.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshes.by_gmsh.child import run_gmsh
from meshes.cells import FloatArray, IntArray
from meshes.errors import MeshError

_PLURALS = {
    (1, 2): "lines",
    (2, 3): "triangles",
    (2, 4): "quadrilaterals",
    (3, 4): "tetrahedra",
    (3, 5): "pyramids",
    (3, 6): "prisms",
    (3, 8): "hexahedra",
}
# What other files begin with or end in, and what makes a mesh of them.
_CAD_ENDINGS = (".step", ".stp", ".stl", ".iges", ".igs", ".brep")
_CAD_BEGINNINGS = (b"ISO-10303", b"solid ", b"DBRep_DrawableShape", b"CASCADE Topology")
# gmsh reads a megabyte in 0.1 s; a broken count may keep it busy for ever.
START_S, S_PER_MB = 30.0, 10.0
_SECTIONS = ("Nodes", "Elements")


@dataclass(frozen=True)
class Kind:
    """A kind of elements.

    Attributes
    ----------
    dimension, order, corners, nodes
        Of one of them.
    places
        Where gmsh puts its nodes in its reference element, shape (nodes, dimension).
    """

    dimension: int
    order: int
    corners: int
    nodes: int
    places: FloatArray

    @property
    def name(self) -> str:
        """For instance ``10-node tetrahedra``."""
        return f"{self.nodes}-node {_PLURALS.get((self.dimension, self.corners), 'elements')}"


@dataclass(frozen=True)
class Elements:
    """All elements of a kind.

    Attributes
    ----------
    numbers
        gmsh's number of each, shape (n,).
    nodes
        gmsh's numbers of their nodes, shape (n, nodes).
    entities
        The geometrical entity each belongs to, shape (n,).
    """

    kind: Kind
    numbers: IntArray
    nodes: IntArray
    entities: IntArray


@dataclass(frozen=True)
class Group:
    """A physical group: its dimension, number, name (which may be empty), and the entities in it."""

    dimension: int
    number: int
    name: str
    entities: tuple[int, ...]


@dataclass(frozen=True)
class Contents:
    """What a file holds.

    Attributes
    ----------
    numbers, points
        gmsh's numbers of the nodes, ascending, and their positions in the file's unit, shape (n, 3).
    elements
        Of dimension 1 and more, a part per kind.
    groups
        Physical groups; one that the file names and puts nothing in has no entities.
    """

    path: Path
    numbers: IntArray
    points: FloatArray
    elements: tuple[Elements, ...]
    groups: tuple[Group, ...]

    def of_dimension(self, dimension: int) -> tuple[Elements, ...]:
        """Elements of a dimension."""
        return tuple(part for part in self.elements if part.kind.dimension == dimension)

    def places(self, nodes: IntArray) -> IntArray:
        """Rows of ``points`` of nodes given by gmsh's numbers."""
        return np.searchsorted(self.numbers, nodes)


def counted(parts: tuple[Elements, ...]) -> str:
    """How many elements of which kinds, for instance ``262 10-node tetrahedra and 94 18-node prisms``."""
    names = [f"{len(part.numbers)} {part.kind.name}" for part in parts]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 2 else names)


def read_contents(path: Path) -> Contents:
    """Read a file.

    Raises
    ------
    MeshError
        If it cannot be read, is no gmsh mesh, is cut off, or gmsh took less from it than it holds.
    """
    content = _whole_file(path)
    declared = _declared(path, content)
    with tempfile.TemporaryDirectory() as folder:
        link, answer = Path(folder) / "mesh.msh", Path(folder) / "mesh.npz"
        link.symlink_to(path.resolve())
        seconds = START_S + S_PER_MB * 1e-6 * len(content)
        failed = f"{path}: gmsh cannot read it"
        run_gmsh("meshes.users.contents", failed, str(link), str(answer), seconds=seconds)
        if not answer.exists():
            raise MeshError(f"{path}: gmsh cannot read it")
        with np.load(answer, allow_pickle=False) as data:
            arrays = dict(data)
    head = json.loads(str(arrays["head"]))
    elements = tuple(
        Elements(Kind(**kind, places=arrays[f"places{k}"]), *(arrays[f"{part}{k}"] for part in _PARTS))
        for k, kind in enumerate(head["kinds"])
    )
    groups = tuple(Group(d, number, name, tuple(entities)) for d, number, name, entities in head["groups"])
    held = {(group.dimension, group.number) for group in groups}
    groups += tuple(Group(*key, name, ()) for key, name in _named(content).items() if key not in held)
    found = Contents(path, arrays["node_numbers"], arrays["points"], elements, groups)
    if head["elements"] != declared:
        raise MeshError(
            f"{path}: declares {declared} elements, of which gmsh took {head['elements']}: their numbers are not all "
            "different, or the file was edited; write it anew with gmsh"
        )
    _check_points(found)
    return found


def _whole_file(path: Path) -> bytes:
    """The contents of a file; refused if it is no whole MSH file."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise MeshError(f"{path}: cannot be read ({error.strerror}); give the path of a gmsh file") from None
    if not re.match(rb"\s*\$(MeshFormat|Comments)\b", content):
        if path.suffix.lower() in _CAD_ENDINGS or content.lstrip().startswith(_CAD_BEGINNINGS):
            what = (
                f"holds a shape and no mesh: make one with: bellowsx mesh {path.name} --size MM --name cavity=NUMBERS"
            )
        elif path.suffix.lower() in (".geo", ".geo_unrolled"):
            what = f"is a script of gmsh: mesh it first with: gmsh -3 -order 2 {path.name} -o {path.stem}.msh"
        else:
            what = (
                "is no gmsh mesh, which begins with $MeshFormat; of formats that gmsh knows (Abaqus, Nastran, MED, "
                f"UNV, VTK) it makes one with: gmsh {path.name} -save -o {path.stem}.msh"
            )
        raise MeshError(f"{path}: {what}")
    for section in _SECTIONS:
        if not re.search(rb"^\$%s\b" % section.encode(), content, re.M):
            raise MeshError(
                f"{path}: has no section ${section}: it was cut off or never meshed; write it anew with gmsh"
            )
        if not re.search(rb"^\$End%s\b" % section.encode(), content, re.M):
            raise MeshError(f"{path}: ends before $End{section}: it was cut off; write it anew with gmsh")
    return content


def _declared(path: Path, content: bytes) -> int:
    """Number of elements that a file declares; of a text file its lines are counted too."""
    try:
        declared, held = _elements(content)
    except (ValueError, IndexError):
        raise MeshError(f"{path}: its $MeshFormat or $Elements cannot be read; write it anew with gmsh") from None
    if held not in (None, declared):
        raise MeshError(
            f"{path}: declares {declared} elements and holds {held}: it was edited; write it anew with gmsh"
        )
    return declared


def _elements(content: bytes) -> tuple[int, int | None]:
    """Number of elements declared, and of those held, which is not known of a binary file."""
    head = re.search(rb"\$MeshFormat\s+(\S+)\s+(\d)\s+\d+\s*?\n(.{4})", content, re.S)
    found = re.search(rb"^\$Elements\s*?\n(.*?)^\$EndElements", content, re.M | re.S)
    if head is None or found is None:
        raise ValueError
    (version, binary, one), body = head.groups(), found[1]
    blocks = float(version) >= 4.0
    if binary == b"1" and blocks:
        order = "<" if one == b"\1\0\0\0" else ">"
        return int(np.frombuffer(body, dtype=f"{order}u8", count=2)[1]), None
    lines = body.split(b"\n")
    numbers = [int(word) for word in lines[0].split()]
    if binary == b"1":
        return numbers[0], None
    held = sum(bool(line.strip()) for line in lines[1:])
    return (numbers[1], held - numbers[0]) if blocks else (numbers[0], held)


def _named(content: bytes) -> dict[tuple[int, int], str]:
    """Physical names that a file declares, by dimension and number."""
    section = re.search(rb"^\$PhysicalNames\b(.*?)^\$EndPhysicalNames", content, re.M | re.S)
    found = re.findall(rb'^\s*(\d+)\s+(\d+)\s+"(.*)"', section[1] if section else b"", re.M)
    return {(int(d), int(number)): name.decode(errors="replace") for d, number, name in found}


def _check_points(found: Contents) -> None:
    """Refuse coordinates that are no numbers."""
    bad = ~np.isfinite(found.points).all(axis=1)
    if bad.any():
        first = int(np.argmax(bad))
        raise MeshError(
            f"{found.path}: node {found.numbers[first]} is at {tuple(found.points[first].tolist())}: "
            f"{int(bad.sum())} nodes have coordinates that are no finite numbers; write the file anew with gmsh"
        )


# --- in the child ---------------------------------------------------------------------------------------------

_PARTS = ("numbers", "nodes", "entities")


def _read_in_this_process(path: str, answer: str) -> None:
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        gmsh.open(path)
    except Exception as error:  # gmsh raises no other
        sys.exit(str(error).replace(path, "the file"))
    mesh = gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    order = np.argsort(tags)
    arrays: dict[str, Any] = {
        "node_numbers": np.asarray(tags, dtype=np.int64)[order],
        "points": np.asarray(coordinates, dtype=float).reshape(-1, 3)[order],
    }
    kinds: list[dict[str, int]] = []
    every = 0
    for kind in mesh.getElementTypes():
        _, dimension, degree, nodes, places, corners = mesh.getElementProperties(kind)
        parts = [_of_entity(mesh, kind, nodes, entity) for entity in _entities(gmsh, dimension)]
        numbers, of, at = (np.concatenate(part) for part in zip(*parts, strict=True))
        every += len(numbers)
        if dimension:
            k = len(kinds)
            kinds.append({"dimension": dimension, "order": degree, "corners": corners, "nodes": nodes})
            arrays |= {f"numbers{k}": numbers, f"entities{k}": at, f"nodes{k}": of}
            arrays[f"places{k}"] = np.asarray(places, dtype=float).reshape(nodes, -1)
    groups = [
        [d, number, gmsh.model.getPhysicalName(d, number), gmsh.model.getEntitiesForPhysicalGroup(d, number).tolist()]
        for d, number in gmsh.model.getPhysicalGroups()
    ]
    gmsh.finalize()
    np.savez(answer, head=json.dumps({"kinds": kinds, "groups": groups, "elements": every}), **arrays)


def _entities(gmsh: Any, dimension: int) -> list[int]:
    return [tag for _, tag in gmsh.model.getEntities(dimension)]


def _of_entity(mesh: Any, kind: int, nodes: int, entity: int) -> tuple[Any, Any, Any]:
    """Numbers, nodes and entity of the elements of a kind in an entity."""
    numbers, of = mesh.getElementsByType(kind, entity)
    numbers = np.asarray(numbers, dtype=np.int64)
    return numbers, np.asarray(of, dtype=np.int64).reshape(-1, nodes), np.full(len(numbers), entity)


if __name__ == "__main__":
    _read_in_this_process(sys.argv[1], sys.argv[2])
