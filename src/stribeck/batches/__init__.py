"""Batches: arrays of states in one call."""
