"""Checks: whether the model applies to a contact, each with a value, a limit, a verdict and a sentence."""
