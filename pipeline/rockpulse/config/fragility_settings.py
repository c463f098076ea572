"""The section [fragility] of the configuration, and the words that its keys know."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from rockpulse.errors import ConfigError
from rockpulse.model_table import EQUATIONS
from rockpulse.option import KeyType, Section, choice, choices, is_number, key, number, text
from rockpulse.record.measures import FRAGILITY, REFERENCE

#: Limit states that are no rotation.
UPLIFT, OVERTURNING = "uplift", "overturning"

DATA = ("stripes", "ida", "cloud")
MODELS = ("lognormal", "logistic")


def _is_limit_states(value: Any) -> bool:
    if not isinstance(value, (list, tuple)) or not value:
        return False
    known = all(
        item in (UPLIFT, OVERTURNING) if isinstance(item, str) else is_number(item) and 0.0 < item <= 1.0
        for item in value
    )
    return known and len(set(value)) == len(value)


def _by_severity(value: Any) -> tuple[str | float, ...]:
    levels = sorted(float(item) for item in value if not isinstance(item, str))
    return (*(item for item in value if item == UPLIFT), *levels, *(item for item in value if item == OVERTURNING))


def _is_levels(value: Any) -> bool:
    return (
        isinstance(value, (list, tuple))
        and bool(value)
        and all(is_number(item) and item > 0.0 for item in value)
        and all(low < high for low, high in pairwise(value))
    )


def _by_value(value: Any) -> tuple[float, ...]:
    return tuple(map(float, value))


_LIMIT_STATES = KeyType(
    'a list of "uplift", numbers in (0, 1] (rotations over alpha_c) and "overturning", each once',
    _is_limit_states,
    _by_severity,
    (UPLIFT, OVERTURNING),
)
_FACTORS = KeyType(
    "two positive numbers [lowest, highest] that ascend", lambda value: _is_levels(value) and len(value) == 2, _by_value
)
_LEVELS = KeyType("a list of positive numbers that ascend", _is_levels, _by_value)


@dataclass(frozen=True)
class FragilitySettings(Section):
    """Limit states, measures and fits of :func:`rockpulse.fragility_curves`.

    `selection` is a table of records that were chosen elsewhere, with their factors or levels and weights, in place of
    `stripe_levels`, `factors` and `pga_min`.

    Raises
    ------
    ConfigError
        For a selection without stripes.
    """

    heading = "[fragility]"
    limit_states: tuple[str | float, ...] = key((UPLIFT, 0.1, 0.4, 0.6, 1.0, OVERTURNING), _LIMIT_STATES)
    measures: tuple[str, ...] = choices(FRAGILITY, FRAGILITY)
    pga_min: float = number(1.0, low=0.0, unit="m/s2")
    data: str = choice("stripes", DATA)
    stripe_measure: str = choice(REFERENCE, FRAGILITY)
    stripe_levels: tuple[float, ...] = key((0.15, 0.25, 0.4, 0.6, 0.9, 1.4), _LEVELS)
    factors: tuple[float, float] = key((0.25, 4.0), _FACTORS)
    selection: str | None = text(None)
    model: str = choice("lognormal", MODELS)
    overturning_model: str = choice("logistic", MODELS)
    confidence: float = number(0.9, low=0.5, high=0.999)
    equation: str = choice(EQUATIONS[0], EQUATIONS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.selection is not None and self.data != "stripes":
            raise ConfigError(
                f'[fragility] selection: records chosen elsewhere are stripes, found data = "{self.data}"; drop one'
            )
