"""The scripts of ``benchmarks/`` as modules: they are no package and are not installed."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def load(script: str, name: str) -> ModuleType:
    """``benchmarks/<script>.py`` executed anew under a module name of its own."""
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{script}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def precise():
    return load("precise_rocking", "precise_rocking")


@pytest.fixture(scope="session")
def precise_with_mpmath():
    """The same with the numbers of mpmath, whether gmpy2 is installed or not."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "gmpy2", None)
        return load("precise_rocking", "precise_rocking_with_mpmath")


@pytest.fixture(scope="session")
def make_reference(precise):
    """It takes the numbers from the module `precise_rocking`, which is loaded by then."""
    return load("make_reference", "make_reference")


@pytest.fixture(scope="session")
def batch():
    return load("batch", "batch_benchmark")


@pytest.fixture(scope="session")
def overturning_probability():
    return load("overturning_probability", "overturning_probability_benchmark")
