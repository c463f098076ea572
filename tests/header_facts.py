"""What the headers of the format samples state twice, and whether a reader tells when the two differ (``make mutate``).

Each fact of a sample is changed to another one of the same width, alone or with those that repeat it. Where another
statement, the samples or the name of the file can tell that it is wrong, its partner, the file must be refused or give
a warning that the unchanged one does not give. Facts without a partner are listed: nothing can be held against them.
"""

import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from make_format_samples import format_samples, read_options

from rockpulse.errors import RockpulseError
from rockpulse.readers import read_source
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.source import HEAD, SourceFile

#: Read with the miniSEED file beside it.
STATION_XML, MINISEED = "CI.CLC.xml", "CI.CLC.mseed"
#: Their headings state the unit: nothing is given.
STATE_THEIRS = frozenset({"clc_three_channels.csv"})


@dataclass(frozen=True)
class HeaderFact:
    """A statement in the header of a sample, and what it can be held against."""

    sample: str
    what: str
    pattern: bytes  # regular expression of the statement
    changed: bytes  # what stands there in the changed file, as wide
    partner: str  # empty where there is none
    places: int = 1  # how many of the matches are changed, from the first on

    def mutated(self) -> bytes:
        """The sample with the changed statement."""
        content = contents()[self.sample]
        found = re.findall(self.pattern, content)
        if len(found) < self.places or {len(text) for text in found[: self.places]} != {len(self.changed)}:
            raise ValueError(f"{self}: found {len(found)} {found[:5]}")
        return re.sub(self.pattern, lambda _: self.changed, content, count=self.places)

    @property
    def format(self) -> str:
        """The format of the sample."""
        return unchanged(self.sample)[0]

    def told(self) -> str:
        """How a reader tells the change: "refusal", "warning", or "silent" where it does not."""
        before = Counter(unchanged(self.sample)[1])
        try:
            after = Counter(said(self.sample, self.mutated())[1])
        except RockpulseError:
            return "refusal"
        return "warning" if after - before else "silent"


@cache
def contents() -> dict[str, bytes]:
    """The samples by name, as they are committed."""
    return format_samples()


@cache
def unchanged(sample: str) -> tuple[str, list[str]]:
    """What `said` gives for a sample as it is committed."""
    return said(sample, contents()[sample])


def said(sample: str, content: bytes) -> tuple[str, list[str]]:
    """The format of a sample with some content, and the warnings of all of its channels."""
    name, beside = sample, [(STATION_XML, contents()[STATION_XML])]
    if sample == STATION_XML:
        name, beside = MINISEED, [(STATION_XML, content)]
        content = contents()[MINISEED]
    given: dict[str, Any] = {} if sample in STATE_THEIRS else read_options().get(name, {})
    file = SourceFile(name, content[:HEAD], lambda: content, lambda: beside)
    records = read_source(file, ReadOptions(**given))
    return records[0].format, [note for record in records for note in record.warnings]


def facts() -> Iterator[HeaderFact]:
    """Every fact of the table header_facts.toml."""
    table = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    for sample, rows in table.items():
        for what, pattern, changed, *others in rows:
            yield HeaderFact(sample, what, pattern.encode("latin-1"), changed.encode("latin-1"), *others)


def main() -> int:
    """Print the table, and how many facts with a partner are told."""
    counts: Counter[str] = Counter()
    print(f"{'format':10} {'sample':40} {'fact':40} {'held against':40} told by")
    for fact in facts():
        told = fact.told() if fact.partner else "nothing to hold it against"
        counts[told] += 1
        print(f"{fact.format:10} {fact.sample:40} {fact.what:40} {fact.partner or '-':40} {told}")
    paired = counts["warning"] + counts["refusal"] + counts["silent"]
    print(
        f"{paired} facts with a partner: {counts['warning']} told by a warning, {counts['refusal']} by a refusal, "
        f"{counts['silent']} silent; {counts['nothing to hold it against']} facts without a partner"
    )
    return min(counts["silent"], 1)


if __name__ == "__main__":
    sys.exit(main())
