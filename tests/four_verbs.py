"""Run assess, calibrate, fragility and report on three of the samples; a warning in our own modules is an error.

``python four_verbs.py data/samples``, in a folder to which the results are written.
"""

import sys
import warnings
from pathlib import Path

warnings.filterwarnings("error", module=r"(rockpulse|rocking)(\.|$)")

from rockpulse.cli import main  # noqa: E402

samples = Path(sys.argv[1])
records = [str(samples / "records" / name) for name in ("CICCC.RAW", "2516b_a.smc", "NP8040-n.1000hyfh.HNE.01.V0c")]
common = ["--config", str(samples / "site.toml"), "--quiet", "--overwrite"]
for command in (
    ["assess", *records, "-o", "results.h5", *common],
    ["calibrate", *records, "-o", "design.h5", *common],
    ["fragility", *records, "-o", "fragility.h5", *common],
    ["report", "results.h5", "-o", "report.html", "--overwrite"],
):
    if code := main(command):
        sys.exit(f"rockpulse {command[0]}: exit code {code}")
    print(f"rockpulse {command[0]}: done")
