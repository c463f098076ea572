"""Check the subjects of the commits of a branch: `make lint` runs it (CONTRIBUTING.md states the rule).

On a branch these are the commits that main does not have, on main those after `SINCE`; merges are exempt.
"""

import re
import subprocess
import sys

#: Last commit that was made before the rule; it moves only if a commit with a fault has reached main.
SINCE = "1f1d2415d69f21b31f07432cb6a718f8c619238b"
LONGEST = 72
#: Verbs that end like a past tense, a participle or a third person, and are none.
VERBS = frozenset({"Bring", "Embed", "Exceed", "Feed", "Need", "Proceed", "Seed", "Shed", "Speed", "Spring", "String"})
NO_VERBS = frozenset({"A", "An", "The", "This", "It", "Its", "All", "Each", "New", "No", "Some", "Now", "Was", "Were"})


def faults(subject: str) -> list[str]:
    """What is wrong with the subject of a commit; an empty list if nothing is."""
    first = re.match(r"[A-Za-z]*", subject)[0]
    third_person = first.endswith("s") and not first.endswith(("ss", "us"))
    found = []
    if len(subject) > LONGEST:
        found.append(f"{len(subject)} characters, at most {LONGEST} are allowed")
    if not first[:1].isupper() or first in NO_VERBS:
        found.append(f"it begins with {subject.split(' ')[0]!r}, expected a capitalised verb in the imperative")
    elif first not in VERBS and (third_person or first.endswith(("ed", "ing"))):
        found.append(f"it begins with {first!r}, expected the imperative ('Skip', not 'Skips', 'Skipped', 'Skipping')")
    if subject.endswith("."):
        found.append("it ends with a full stop")
    return found


def git(*arguments: str) -> str | None:
    """What git prints; None if it fails."""
    done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else None


def commits(since: str = SINCE) -> list[tuple[str, str]] | None:
    """Abbreviated hash and subject of every commit to be checked; None if the history lacks the commit `since`."""
    main = git("rev-parse", "-q", "--verify", "main") or git("rev-parse", "-q", "--verify", "origin/main")
    excluded = [f"^{main}"] if main and main != git("rev-parse", "HEAD") else []
    log = git("log", "--no-merges", "--format=%h %s", "HEAD", f"^{since}", *excluded)
    return None if log is None else [tuple(line.split(" ", 1)) for line in log.splitlines()]


def main() -> int:
    """Print a line for every commit with a fault; 1 if there is one."""
    found = commits()
    if found is None:
        print(f"subjects of commits: not checked, for the history here does not reach back to {SINCE[:8]}")
        return 0
    wrong = [f"commit {name} {subject!r}: {fault}" for name, subject in found for fault in faults(subject)]
    if wrong:
        print(*wrong, "change it: git commit --amend, or git rebase -i main", sep="\n")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
