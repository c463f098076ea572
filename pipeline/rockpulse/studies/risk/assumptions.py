"""What an annual frequency takes for granted, in words: of the fragility, and of the hazard."""

from __future__ import annotations

from collections.abc import Iterable

from rockpulse.config.configuration import Config

__all__ = ["fragility_assumed", "hazard_assumed", "several_events"]

#: The horizontal component that a hazard has to be of, by [records] components.
COMPONENTS = {
    "horizontal": "any single horizontal component, as each channel is a motion of its own, not the larger of two",
    "azimuth": "a single horizontal component in a given direction, not the larger of two",
    "strongest": "the horizontal component in the direction of the strongest motion, not of any single one",
    "sweep": "any single horizontal component, as each direction is a motion of its own, not the larger of two",
}

#: What the fragility is the probability of, by [fragility] data.
DATA = {
    "stripes": "records scaled to levels (stripes)",
    "ida": (
        "the first level at which each record reaches the limit state (ida); a body may stand at higher ones, so the "
        "frequency is none too small"
    ),
    "cloud": "records as they are, not scaled (cloud)",
}


def several_events(count: int) -> str:
    """The number of earthquakes in words."""
    return "1 earthquake" if count == 1 else f"{count} earthquakes"


def hazard_assumed(remarks: Iterable[str], config: Config) -> str:
    """The remarks on a hazard, and for which ground and which component it has to be given."""
    wanted = f"to be of the ground below the bodies, and of {COMPONENTS[config.records.components]}"
    return "; ".join([*remarks, wanted])


def fragility_assumed(config: Config, model: str, records: int, events: int) -> str:
    """The fragility of a file: its data, its distribution, and how records count."""
    settings = config.fragility
    of = "records chosen elsewhere" if settings.selection is not None else DATA[settings.data]
    alike = "by their weights" if settings.selection is not None else "alike"
    shown = f"{records} record{'' if records == 1 else 's'} of {several_events(events)}"
    return f"of {of}; {model}, {settings.equation} equation, {shown}, in which records count {alike}"
