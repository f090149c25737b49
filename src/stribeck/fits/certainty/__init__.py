"""How well the data determine what was fitted: linear, by profiles of the likelihood, by sampling."""
