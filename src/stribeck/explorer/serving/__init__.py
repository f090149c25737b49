"""What the server of the page needs that is no page: its door, and the memory of pages that closed."""
