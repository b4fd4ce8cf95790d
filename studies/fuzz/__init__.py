"""Generated inputs: scenes drawn from the whole schema, damaged files, and what becomes of each."""
