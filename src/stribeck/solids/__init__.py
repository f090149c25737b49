"""Solids: the deflection of a surface under a pressure."""
