"""Cold starts of models that are not the article's: films that end, other fluids, other solids."""
