"""States of a ball whose film breaks: at ambient pressure, or at that of a cavity behind which it forms anew."""
