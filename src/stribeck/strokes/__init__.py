"""Strokes, starts and stops of a line contact: friction and films in time."""
