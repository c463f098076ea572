"""Runs the command line as ``python -m rockpulse``, if the script ``rockpulse`` is not on the path."""

import sys

from rockpulse.cli import main

sys.exit(main())
