"""The state of a page: its inputs, the parts of its model, its address and its history."""
