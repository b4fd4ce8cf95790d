"""Pictures of bodies in their states, drawn from fields and states that were kept."""
