"""The verb assess on files of one burst, and what it stores, read by bare h5py."""

import h5py
import numpy as np
from nominal import FILE

DT = 0.01
TIME = DT * np.arange(800)
#: A burst of 1 Hz with 0.45 g in its middle and next to nothing at its ends [g].
STRONG = 0.45 * np.sin(2.0 * np.pi * TIME) * np.exp(-(((TIME - 4.0) / 1.2) ** 2))


def write_at2(path, acceleration, component="90", event="TEST EVENT"):
    lines = [
        "PEER STRONG MOTION DATABASE RECORD",
        f"{event}, STATION A, {component}",
        "ACCELERATION TIME SERIES IN UNITS OF G",
    ]
    lines.append(f"NPTS= {acceleration.size}, DT= {DT:.4f} SEC")
    lines += ["".join(f"{value:15.7E}" for value in row) for row in np.split(acceleration, acceleration.size // 5)]
    path.write_text("\n".join(lines) + "\n")
    return path


#: One model, without factors, spectra or probability.
QUICK = """[models]
use = ["linear"]
[search]
models = []
[uncertainty]
probability = false
"""
BLOCKS = ["--block", "thin wall=0.2x2.2", "--block", "pier=1.0x3.0"]


def assess_words(*arguments):
    """The command that assesses some files on two bodies."""
    return ["assess", *map(str, arguments), *([] if "--config" in arguments else ["--config", str(FILE)]), *BLOCKS]


def values(path, name):
    """A variable of /summary, or of another group that is named, by bare h5py."""
    with h5py.File(path) as file:
        found = file[name if "/" in name else f"summary/{name}"]
        return (found.asstr() if found.dtype == object else found)[:].tolist()


def configuration(path):
    with h5py.File(path) as file:
        return file.attrs["configuration"]
