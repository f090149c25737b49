"""Films that break: of a ball at ambient pressure or at that of a cavity, and cavities of the line that open and close."""
