"""The study of the dimensions that the paper does not print."""
