"""Contacts without a fluid: Hertz, and rough contacts at rest."""
