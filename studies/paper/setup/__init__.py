"""What is solved: sizes and where they come from, silicones, elements and meshes; from scenes and code, not typed."""
