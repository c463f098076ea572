"""The commands of rockpulse (verbs): each module defines one as ``VERB``, and imports what it needs when it runs."""

from importlib import import_module

from rockpulse.commands.parser import Verb

#: Modules of the commands, in the order of the help.
_MODULES = """assess inspect plot report export diff verify calibrate select fragility risk check init_config formats
convert selftest app completion"""

VERBS: tuple[Verb, ...] = tuple(import_module(f"{__name__}.{name}").VERB for name in _MODULES.split())
