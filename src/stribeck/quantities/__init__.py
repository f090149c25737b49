"""Quantities: units, inputs with their bounds, and what an input error says."""
