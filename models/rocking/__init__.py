"""Numerics of rocking blocks on floats and arrays, in SI units.

Nothing in here knows of files, obspy or xarray; the package imports only the standard library, numpy, scipy and numba.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
