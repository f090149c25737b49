"""States along a path: solved one after another, expanded in series, and known at any place between them."""
