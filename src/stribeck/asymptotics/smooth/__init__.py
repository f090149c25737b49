"""Films without asperities: inlet and outlet layers, thin films, rigid bodies."""
