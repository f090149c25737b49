"""Surfaces: from measured heights to a spectrum and a contact law."""
