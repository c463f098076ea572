"""rockpulse: overturning safety of large slender rigid blocks from strong-motion records; names load on first use."""

import lazy_loader

from rockpulse.version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
