"""Experiments: what to measure next, and which contact law the data prefer."""
