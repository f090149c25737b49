"""Fits: parameters of the model from measured friction curves, with their intervals."""
