"""The fit of the error model in `studies.planning.error_model`, and its check on scenes it has not seen."""
