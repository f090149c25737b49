"""The table of a laboratory: what its columns are, what they are made of, and their values in SI units."""
