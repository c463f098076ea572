"""The errors that rockpulse raises on purpose.

Every class can be made of its message alone, so that it survives pickling on its way back from a worker process.
File-system faults stay :class:`OSError`.
"""

from __future__ import annotations

__all__ = [
    "ConfigError",
    "RecordFormatError",
    "RecordRefused",
    "ResultsError",
    "RockpulseError",
    "StoppedAtFailure",
    "TooWeak",
    "UnitError",
]


class RockpulseError(ValueError):
    """Base of every error whose message tells the user what was found, what was expected and what to do."""


class RecordFormatError(RockpulseError):
    """A file that claims a format but breaks its rules, or that no reader recognises."""


class RecordRefused(RockpulseError):
    """A well-formed file that holds no usable ground acceleration (velocity, spectra, counts without a gain)."""


class TooWeak(RecordRefused):
    """A record that moves too few bodies to tell anything: "skipped", for nothing is wrong with its file."""


class UnitError(RockpulseError):
    """A unit that is missing, unknown, or contradicts the file."""


class ConfigError(RockpulseError):
    """A configuration file or command-line option that cannot be used."""


class ResultsError(RockpulseError):
    """A results file that cannot be written, or is not one that this version reads.

    Attributes
    ----------
    tells_resume : bool
        Whether the message says what becomes of a run that was stopped, and how to go on with it.
    """

    def __init__(self, message: str, tells_resume: bool = False) -> None:
        super().__init__(message)
        self.tells_resume = tells_resume


class StoppedAtFailure(RockpulseError):
    """A batch that was to stop at the first file or record that fails, and did."""
