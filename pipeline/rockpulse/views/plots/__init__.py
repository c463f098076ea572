"""Pictures of results: each takes Axes or makes its own, and returns them; nothing is shown, no global is changed."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
