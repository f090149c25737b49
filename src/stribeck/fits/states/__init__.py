"""The states of a fit, with their derivatives: off the atlas, solved, or read between solved ones."""
