"""Batches: arrays of states in one call, solved in chains along which each starts from its neighbour."""
