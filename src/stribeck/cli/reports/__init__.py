"""Reports: results in words and as JSON."""
