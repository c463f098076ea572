"""The version of rockpulse, used by the build and the command line and stored in every file."""

__version__ = "0.2.0"
