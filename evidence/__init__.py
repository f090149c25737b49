"""Evidence for the numbers: maps of the errors of formulas, the atlas and its certificate; not in the wheel."""
