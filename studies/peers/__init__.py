"""The same problem solved by other codes: meshes for all of them, one script each, and their environment."""
