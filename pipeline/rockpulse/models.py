"""Numerics of rocking blocks: the public names of the package :mod:`rocking`, loaded on first use."""

import rocking

__getattr__, __dir__, __all__ = rocking.__getattr__, rocking.__dir__, rocking.__all__
