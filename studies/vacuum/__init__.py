"""What bellows contract to under vacuum."""
