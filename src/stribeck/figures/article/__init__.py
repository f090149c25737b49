"""The figures of the article, one module each."""
