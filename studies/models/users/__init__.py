"""Users' meshes as boundary value problems."""
