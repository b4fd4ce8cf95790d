"""Scenes from Python: ``from bellowsx import Scene, solve``. A thin layer over ``studies``, which does the work."""

from bellowsx.interface import Answer, Scene, solve

__all__ = ["Answer", "Scene", "solve"]
