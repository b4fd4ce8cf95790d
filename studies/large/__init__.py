"""Direct against iterative linear algebra over size."""
