"""The server around the page: access control, and the memory of closed pages."""
