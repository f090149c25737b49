"""Fluids that thin under a ball: the flow across the film, and what it carries in the plane."""
