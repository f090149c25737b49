"""Uncertainty: what errors of the inputs make of films, friction, transitions and the regime."""
