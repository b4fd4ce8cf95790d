"""The same rows on every stack, and what each costs."""
