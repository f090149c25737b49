"""Curves as functions: states expanded into Taylor series, and interpolation between them."""
