"""The vacuum study: contraction of bellows whose cavity is evacuated."""
