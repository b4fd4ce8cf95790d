"""Contact: exact problems, and folds that touch."""
