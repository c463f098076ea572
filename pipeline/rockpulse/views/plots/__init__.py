"""Pictures of results on given or new Axes, which are returned; no window is opened, no global setting is changed."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
