"""Public functions that draw results on given or new Axes and return the Axes; they are loaded on first use."""

from rockpulse.views import plots

__getattr__, __dir__, __all__ = plots.__getattr__, plots.__dir__, plots.__all__
