"""Pictures of all results, one module a subject, in one style."""
