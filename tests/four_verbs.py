"""Run assess, calibrate, fragility and report on the samples; a warning in our own modules is an error.

``python four_verbs.py data/samples``, in a folder to which the results are written.
"""

import sys
import warnings
from pathlib import Path

warnings.filterwarnings("error", module=r"(rockpulse|rocking)(\.|$)")

from rockpulse.cli import main  # noqa: E402

samples = Path(sys.argv[1])
common = ["--config", str(samples / "site.toml"), "--quiet", "--overwrite"]
for command in (
    ["assess", str(samples / "records"), "-o", "results.h5", *common],
    ["calibrate", str(samples / "records"), "-o", "design.h5", *common],
    ["fragility", str(samples / "records"), "-o", "fragility.h5", *common],
    ["report", "results.h5", "-o", "report.html", "--overwrite"],
):
    if code := main(command):
        sys.exit(f"rockpulse {command[0]}: exit code {code}")
    print(f"rockpulse {command[0]}: done")
