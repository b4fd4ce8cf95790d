"""The study in miniature: two convolutions by every model."""
