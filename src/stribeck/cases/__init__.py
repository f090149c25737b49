"""Cases: the TOML files that describe a contact."""
