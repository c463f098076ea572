"""Helpers for the readers of formats, which use them as `kit.NAME`; CONTRIBUTING.md lists the most frequent ones."""

# ruff: noqa: F401, F403 - the formats use these names

from rockpulse.readers.kit.channel import *
from rockpulse.readers.kit.checks import *
from rockpulse.readers.kit.direction import *
from rockpulse.readers.kit.facts import *
from rockpulse.readers.kit.headings import *
from rockpulse.readers.kit.motion_kinds import *
from rockpulse.readers.kit.number_table import *
from rockpulse.readers.kit.prose import *
from rockpulse.readers.kit.spacing import *
from rockpulse.readers.kit.text import *
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record.record import STANDARD_GRAVITY, Record
