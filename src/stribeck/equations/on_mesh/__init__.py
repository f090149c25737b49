"""The line on a mesh: the film at its nodes, the inverse of the Jacobian, and the same panels with more nodes."""
