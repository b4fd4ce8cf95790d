"""The study of the closed form: chains, mends, validity, material laws, speed."""
