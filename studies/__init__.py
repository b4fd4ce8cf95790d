"""Scenes, plans, runs, comparison rows, reports and the command line."""
