"""The version of rockpulse, which is written to every results file."""

__version__ = "0.2.0"
