"""Shear-thinning fluids under a ball: the flow across the film, and the flux in its plane."""
