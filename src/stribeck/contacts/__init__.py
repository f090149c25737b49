"""Contacts: the inputs in SI units, the dimensionless groups and the Hertz scales."""
