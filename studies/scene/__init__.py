"""What is requested: scenes of bellows and of simple bodies, their sections and keys, files of sweeps."""
