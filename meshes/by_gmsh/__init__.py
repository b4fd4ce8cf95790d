"""What gmsh meshes or reads, always in a child process: it may abort."""
