"""Pictures of results: the package :mod:`rockpulse.views.plots` under its public name."""

import sys

import rockpulse.views.plots

sys.modules[__name__] = rockpulse.views.plots
