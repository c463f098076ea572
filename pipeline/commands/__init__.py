"""The verbs of the command line: each module has ``add_parser(subparsers)`` and ``run(args) -> int``.

What a verb needs beyond the standard library is imported inside ``run``.
"""

from rockpulse.commands import assess, formats, init_config, inspect

__all__ = ["VERBS"]

#: In the order of the help.
VERBS = (assess, inspect, formats, init_config)
