"""The version of rockpulse, which the build and the command line use and every results file contains."""

__version__ = "0.2.0"
