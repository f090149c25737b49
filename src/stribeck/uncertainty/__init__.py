"""Uncertainty: errors of the inputs, propagated to films, friction, transitions and regimes."""
