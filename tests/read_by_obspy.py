"""Read records by ``obspy.read`` where rockpulse is installed and nothing of its source tree is in sight.

``make wheel`` (.ci/versions) runs this from a folder of its own with the interpreter of a fresh environment:

    python read_by_obspy.py FOLDER...

Exit code 1 if a file is not read, differs when read from memory, or if rockpulse comes from a source tree.
"""

import importlib.metadata
import io
import sys
import sysconfig
import warnings
from pathlib import Path

from make_format_samples import read_options

#: Read by obspy's own plugins, and files that are no waveforms.
PASSED_OVER = {".mseed", ".sac", ".xml", ".md", ".ew", ".ns", ".ud"}


def main(folders: list[str]) -> int:
    """Read every file of some folders as a path and as bytes; the exit code is 1 if anything is wrong."""
    import obspy

    import rockpulse

    faults, options = [], read_options()
    site = Path(sysconfig.get_path("purelib"))
    if site not in Path(rockpulse.__file__).parents:
        faults.append(f"rockpulse comes from {rockpulse.__file__}, expected below {site}")
    names = {point.name for point in importlib.metadata.entry_points(group="obspy.plugin.waveform")}
    own = {point.name for point in importlib.metadata.distribution("rockpulse").entry_points} & names
    unread = set(own)
    paths = [path for folder in folders for path in sorted(Path(folder).iterdir()) if path.is_file()]
    for path in (path for path in paths if path.suffix.lower() not in PASSED_OVER):
        # Columns are read where they are asked for by name; they alone do not say everything.
        named = {"format": "COLUMNS", **options[path.name]} if path.name in options else {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                stream = obspy.read(path, **named)
            again = obspy.read(io.BytesIO(path.read_bytes()), **named)
        except Exception as fault:  # whatever it is, it is a fault of the installation
            faults.append(f"{path}: {type(fault).__name__}: {fault}")
            continue
        unread -= {trace.stats._format for trace in stream}
        peak = max(abs(trace.data).max() for trace in stream)
        print(f"{path.name}: {stream[0].stats._format}, {len(stream)} traces, largest {peak:.4g} m/s2")
        if len(again) != len(stream) or any((a.data != b.data).any() for a, b in zip(stream, again, strict=True)):
            faults.append(f"{path}: other samples from bytes than from the path")
        if any(trace.stats.calib != 1.0 or trace.stats._format not in own for trace in stream):
            faults.append(f"{path}: not read by rockpulse, or calib is not 1")
    if not paths:
        faults.append("no file to read")
    print("\n".join(["", *faults, f"{len(own)} plugins, without a file here: {', '.join(sorted(unread)) or 'none'}"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
