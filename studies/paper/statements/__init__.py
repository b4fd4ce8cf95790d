"""What the paper says, and whether the rows of the reference and of the drawn sets say so too."""
