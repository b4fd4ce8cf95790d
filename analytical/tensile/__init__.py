"""Material tests: what was measured in a homogeneous state, laws fitted to it, and how well."""
