"""What will be solved for a scene, what is skipped and why, what it will cost and leave of error."""
