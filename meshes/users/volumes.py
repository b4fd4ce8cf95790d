"""Named volumes of a user's mesh, in which it may be of another material: physical surfaces of a meridian."""

from __future__ import annotations

import numpy as np

from meshes.cells import IntArray
from meshes.errors import MeshError
from meshes.solid import FIRST_VOLUME, REGIONS
from meshes.users.contents import Contents, Elements

Volumes = tuple[tuple[int, tuple[str, ...]], ...]


def named_volumes(contents: Contents, elements: Elements) -> tuple[IntArray, Volumes]:
    """Region number of each cell, and the names of the groups that each region is in.

    Cells of the same groups make a region. That of the first cell is ``elastomer``, as a mesh of one material is; the
    others count from ``FIRST_VOLUME``.

    Raises
    ------
    MeshError
        If a name is given to nothing.
    """
    dimension = elements.kind.dimension
    groups = [group for group in contents.groups if group.dimension == dimension and group.name]
    names = tuple(dict.fromkeys(group.name for group in groups))
    inside = np.zeros((len(elements.numbers), len(names)), dtype=bool)
    for group in groups:
        inside[:, names.index(group.name)] |= np.isin(elements.entities, group.entities)
    if names and not inside.any(axis=0).all():
        empty = names[int(np.argmin(inside.any(axis=0)))]
        what = "volume" if dimension == 3 else "surface"
        raise MeshError(f"{contents.path}: physical {what} {empty!r} holds no cells: put some in, or delete the group")
    combined, first, back = np.unique(inside, axis=0, return_index=True, return_inverse=True)
    place = np.argsort(np.argsort(first))
    numbers = np.where(place == 0, REGIONS["elastomer"], FIRST_VOLUME - 1 + place)
    regions = numbers[np.ravel(back)]
    found = zip(numbers.tolist(), combined, strict=True)
    return regions, tuple(
        (number, tuple(np.array(names)[row].tolist())) for number, row in sorted(found, key=lambda f: f[0])
    )
