"""Bodies with exact and with published answers."""
