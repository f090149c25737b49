"""The charts of the explorer and their pictures."""
