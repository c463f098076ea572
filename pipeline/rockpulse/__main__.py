"""``python -m rockpulse``: the command line where the console script is not on the path."""

import sys

from rockpulse.cli import main

sys.exit(main())
