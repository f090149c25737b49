"""What the numbers rest on: maps of the errors of formulas, the atlas and its certificate. Not in the wheel."""
