"""What a journal is worth to a run: what need not be done again, and what a run that stops has to say of it."""

from __future__ import annotations

from rockpulse.batch.journal import Journal
from rockpulse.batch.plan import Plan
from rockpulse.batch.tasks import UNFINISHED

__all__ = ["finished", "kept", "worth"]


def finished(journal: Journal, made: Plan) -> list[str]:
    """Keys of the tasks whose results are in the journal, in the order of the plan.

    Parameters
    ----------
    journal : Journal
        Open.
    made : Plan
        Results of another configuration, or of files that have changed since, are none of its.
    """
    before = journal.finished()
    return [task.key for task in made.tasks if before.get(task.key) == task.fingerprint]


def worth(journal: Journal) -> set[str]:
    """Tasks in a journal that need not be done again, of whatever plan.

    Parameters
    ----------
    journal : Journal
        Open.
    """
    return {key for key, fingerprint in journal.finished().items() if fingerprint != UNFINISHED}


def kept(journal: Journal, made: Plan) -> str:
    """What a run that stops has to say; a journal without anything in it is removed.

    Parameters
    ----------
    journal : Journal
        Open.
    made : Plan
        Its records are counted; all that the journal has where there is no plan yet.
    """
    if not journal.in_place:
        return f"nothing is kept, for {journal.path} was removed while the run was at work"
    every = worth(journal)
    if not every:
        journal.remove()
        return "nothing was finished yet"
    count = len(finished(journal, made)) if made.tasks else len(every)
    if not count:
        return (
            f"nothing of this run was finished yet; {journal.path} keeps {len(every)} records of other files or options"
        )
    are = "record is" if count == 1 else "records are"
    return f"{count} finished {are} kept in {journal.path}: the same command with --resume goes on from there"
