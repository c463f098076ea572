"""The verbs of the command line: each module holds one as ``VERB``.

What a verb needs beyond the standard library is imported when it runs.
"""

from rockpulse.commands import accuracy, assess, convert, formats, init_config, inspect

__all__ = ["VERBS"]

#: In the order of the help.
VERBS = (assess.VERB, inspect.VERB, formats.VERB, convert.VERB, init_config.VERB, accuracy.VERB)
