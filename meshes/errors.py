"""The errors of this package."""


class GeometryError(ValueError):
    """A shape that cannot be built: the message names the value, the violated inequality and the remedy."""


class MeshError(RuntimeError):
    """A mesh that could not be made or is not fit for use: the message says where."""
