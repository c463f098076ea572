"""Numerics of rocking blocks in SI units, by numpy, scipy and numba alone."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
