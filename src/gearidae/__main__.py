"""``python -m gearidae``."""

import sys

from gearidae.cli import main

if __name__ == "__main__":
    sys.exit(main())
