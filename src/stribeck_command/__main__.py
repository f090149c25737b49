"""``python -m stribeck_command`` is the command ``stribeck``."""

import sys

from stribeck_command import main

if __name__ == "__main__":
    sys.exit(main())
