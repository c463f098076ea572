"""Numerics of rocking blocks: the package :mod:`rocking` under its public name."""

import sys

import rocking

sys.modules[__name__] = rocking
