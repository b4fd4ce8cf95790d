"""The study of the closed form: chains, corrections, validity, material laws, speed."""
