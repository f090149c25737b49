"""Fluids: what a film of a given gap carries and drags."""
