"""The solver of the point contact: from groups to a state of a ball on a flat that holds its tolerance."""
