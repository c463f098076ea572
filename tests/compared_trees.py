"""Compare two trees of results in memory."""

from contextlib import nullcontext

from rockpulse.views.diff.difference_overview import difference_overview
from rockpulse.views.diff.differences import compare_results


class InMemory:
    """A tree in place of an open file."""

    kind, path = "assessment", "results.h5"

    def __init__(self, made):
        self.attrs, self.groups = made.attrs, tuple(made.children)
        self.dataset = lambda group: made[group].to_dataset(inherit=False)
        self.reading = nullcontext


def compare(first, second, **options):
    """The differences of two trees and their text."""
    one, other = InMemory(first), InMemory(second)
    found = compare_results(one, other, **options)
    return found, difference_overview(found, one, other, "rtol 1e-09")
