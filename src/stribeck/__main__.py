"""``python -m stribeck`` is the command ``stribeck``."""

import sys

from stribeck.cli import main

if __name__ == "__main__":
    sys.exit(main())
