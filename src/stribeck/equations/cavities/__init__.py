"""Films of a ball that break: at ambient pressure, or at that of a cavity behind which they re-form."""
