"""Sweeps: many states over a design, kept one by one, in several processes."""
