"""Where states lose stability, in which mode, and against which harmonics of the angle."""
