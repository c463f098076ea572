"""How a motion ends, and why a model cannot say it: the codes of responses and of results."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["Outcome", "Reason"]


class Outcome(IntEnum):
    """How a motion ends."""

    AT_REST = 0  #: never uplifted
    ROCKS = 1  #: uplifted, and comes back to rest or to a bounded motion
    OVERTURNS = 2
    UNRESOLVED = 3  #: the model cannot say; see the reason

    @property
    def word(self) -> str:
        """The name as results hold it: "at_rest", "rocks", "overturns" or "unresolved"."""
        return self.name.lower()


class Reason(IntEnum):
    """Why a lane is UNRESOLVED."""

    NONE = 0
    IMPACT_LIMIT = 1  #: more impacts in a row than the solver follows (restitution of one or next to it)
    FREE_FLIGHT = 2  #: the vertical acceleration cancels gravity: the block leaves the ground
    HALF_CYCLE_LIMIT = 3  #: more half-cycles than the model follows
    NO_SEQUENCE = 4  #: the record gave no impulse sequence to answer with
    SHORT_INTERVAL = 5  #: secondary impulses too close for the march; the limit is spacing="continuous"
    NOT_MODELLED = 6  #: the model does not know what the body has: unlike corners, a wall, ties, loads or thrusts
