"""Profiles: the shape of the rigid body of a line contact, where it is no parabola."""
