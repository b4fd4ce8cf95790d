"""The command line: one module per command; options, exit codes and messages they share are in `common`."""
