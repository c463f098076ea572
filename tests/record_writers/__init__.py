"""Small format-faithful record files, written from numbers that the tests choose: one module per family.

Every module with a function ``samples(channels) -> {file name: bytes}`` adds to data/samples/formats (see
tests/make_format_samples.py).
"""

from record_writers._shared import pulse, rows
from record_writers.at2 import at2
from record_writers.csmip_v1 import csmip_equal, csmip_pairs
from record_writers.knet import knet
from record_writers.smc import smc

__all__ = ["at2", "csmip_equal", "csmip_pairs", "knet", "pulse", "rows", "smc"]
