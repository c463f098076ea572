"""Pictures of results: each takes Axes or makes its own, and returns them; loaded on first use."""

from rockpulse.views import plots

__getattr__, __dir__, __all__ = plots.__getattr__, plots.__dir__, plots.__all__
