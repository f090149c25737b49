"""Numerical methods that know no physics: Newton, continuation, panels of polynomials, threads."""
