"""The solver: from groups to a solution that holds its tolerance."""
