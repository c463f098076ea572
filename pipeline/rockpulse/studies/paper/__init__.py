"""The parametric study of Casapulla & Maione (2017), section 4, as datasets with a verdict on each statement."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
