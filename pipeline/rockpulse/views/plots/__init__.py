"""Pictures of results, drawn on given or new Axes; no window is opened and no global setting is changed."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
