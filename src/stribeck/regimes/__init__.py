"""Regimes: where boundary, mixed and hydrodynamic lubrication begin and end."""
