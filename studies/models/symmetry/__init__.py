"""Bodies that are solved on a part of them between planes of symmetry."""
