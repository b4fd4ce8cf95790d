"""Pictures of the paper study."""
