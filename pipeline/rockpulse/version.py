"""The version of rockpulse: read by the build, told by the command line, stored in every file."""

__version__ = "0.2.0"
