"""What do bellows contract to when their cavity is evacuated, with contact of their folds?"""
