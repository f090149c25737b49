"""The atlas: solved states of a box of groups as smooth functions."""
