"""What a page is asked: its inputs, the parts of its model, its address and its history."""
