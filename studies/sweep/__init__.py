"""The map over root radius, wall and convolutions: where the closed form misleads."""
