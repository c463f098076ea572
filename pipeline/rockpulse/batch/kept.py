"""The worth of a journal to a run: the tasks that need not be done again, and the message of a run that stops."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rockpulse.batch.journal import UNFINISHED, Journal
from rockpulse.batch.plan import Task

__all__ = ["finished", "kept", "worth"]


def finished(journal: Journal, tasks: Iterable[Task]) -> list[str]:
    """Keys of the tasks whose results are in the journal, in order.

    Results of another configuration, or of files that have changed since, are none of theirs.
    """
    before = journal.finished()
    return [task.key for task in tasks if before.get(task.key) == task.fingerprint]


def worth(journal: Journal) -> set[str]:
    """Tasks in a journal that need not be done again, of whatever run."""
    return {key for key, fingerprint in journal.finished().items() if fingerprint != UNFINISHED}


def kept(journal: Journal, tasks: Sequence[Task], strict: bool = False) -> str:
    """The message of a run that stops on its tasks, or on all in the journal where it has no tasks yet.

    A journal without anything in it is removed. `strict` says that the run stopped at a failure because it was to.
    """
    if not journal.in_place:
        return f"nothing is kept, for {journal.path} was removed while the run was at work"
    every = worth(journal)
    if not every:
        journal.remove()
        return "nothing was finished yet"
    count = len(finished(journal, tasks)) if tasks else len(every)
    if not count:
        return (
            f"nothing of this run was finished yet; {journal.path} keeps {len(every)} records of other files or options"
        )
    are = "record is" if count == 1 else "records are"
    past = ", past this failure without --strict" if strict else ""
    return f"{count} finished {are} kept in {journal.path}: the same command with --resume goes on from there{past}"
