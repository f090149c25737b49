"""What people write for an input: data-sheet values that are converted, values with errors, and advice on wrong names."""
