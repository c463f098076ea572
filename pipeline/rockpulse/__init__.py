"""rockpulse: overturning safety of large slender rigid blocks from strong-motion records."""

import lazy_loader

from rockpulse.version import __version__ as __version__

_of_stub, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Import a public name on first use; for an unknown name raise AttributeError with the nearest public name."""
    try:
        return _of_stub(name)
    except AttributeError:
        from difflib import get_close_matches

        near = get_close_matches(name.lower(), __all__, n=1)
        did_you_mean = f"; did you mean {near[0]!r}?" if near and not name.startswith("_") else ""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{did_you_mean}") from None
