"""Run time against error of every model, mesh and way of stepping; the error model's fit."""
