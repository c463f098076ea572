"""Test of the design of a site on earthquakes left out: the share that is more severe than the design.

``python -m laboratory.site PATHS -o FOLDER`` (``make site RECORDS=FOLDER``) prints the table and writes it as CSV. A
record takes two seconds on one core in the first run; its data are stored in ``FOLDER/records``.
"""

import argparse
import logging
from pathlib import Path

import numpy as np

from laboratory.ensemble import add_record_arguments, read_strong
from laboratory.site.judgement import Site, judge, known_of
from laboratory.tables import plain, write_tables
from rockpulse.studies.site.spectrum_design import FEWEST_EVENTS

#: Weaker records are left out [m/s2].
LEAST = 1.0


def main() -> None:
    """Judge, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_record_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the table and the stored spectra")
    parser.add_argument("--draws", type=int, default=20, help="draws of halves of the earthquakes")
    parser.add_argument("--seed", type=int, default=0, help="seed of halves and resamples")
    args = parser.parse_args()
    logging.disable(logging.WARNING)
    motions = read_strong(args, LEAST)
    names, events = np.unique([motion.event for motion in motions], return_inverse=True)
    if names.size < 2 * FEWEST_EVENTS:
        parser.exit(1, f"{names.size} earthquakes with records above {LEAST:g} m/s2, {2 * FEWEST_EVENTS} are needed\n")
    folder = args.output / "records"
    folder.mkdir(parents=True, exist_ok=True)
    known = [known_of(motion, folder) for motion in motions]
    site = Site(events, **{name: np.array([one[name] for one in known]) for name in known[0]})
    table = judge(site, args.draws, seed=args.seed)
    write_tables(args.output, {"site": table})
    print(f"{len(motions)} records of {names.size} earthquakes ({', '.join(names)}); 12 bodies")
    shown = {"left_out": str, "method": str} | dict.fromkeys(table.columns[2:], "{:.2f}".format)
    print(plain(table, shown | {"earthquakes": str}))


if __name__ == "__main__":
    main()
