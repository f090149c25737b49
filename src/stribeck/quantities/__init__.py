"""Quantities: units, inputs with their bounds, and error messages."""
