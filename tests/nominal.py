"""Configurations of the nominal bodies: every factor searched, and no probability, which costs a second a record."""

from dataclasses import replace
from pathlib import Path

import rockpulse as rp

#: The same for the command line.
FILE = Path(__file__).with_name("nominal.toml")


def Config(**sections):
    search = replace(sections.pop("search", rp.SearchSettings()), intervals=True)
    return rp.Config(**{"uncertainty": rp.UncertaintySettings(probability=False)} | sections, search=search)
