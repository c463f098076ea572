"""``python -m rockpulse``: the command line if the console script is not on the path."""

import sys

from rockpulse.cli import main

sys.exit(main())
