"""What came out: comparison rows, files of runs and states, measures, uncertainty, where a number came from."""
