"""Asperities and fluid together: boundary and mixed lubrication, transitions, the uniform friction law."""
