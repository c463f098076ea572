"""rockpulse: from recorded strong-motion files to the overturning safety of large slender rigid blocks.

The public names are loaded on first use, so that a reader plugin or ``rockpulse --help`` costs next to nothing.
"""

import lazy_loader

from rockpulse.version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
