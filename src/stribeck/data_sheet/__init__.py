"""Data sheets: a new case to fill in, and one page of results to hand over."""
