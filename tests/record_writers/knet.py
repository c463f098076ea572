"""K-NET and KiK-net ASCII."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.record.record import Record


def knet(
    counts: Sequence[int],
    scale: str = "2000(gal)/8388608",
    peak_gal: float = 0.0,
    direction: str = "E-W",
    origin: str = "1996/08/11 03:12:00",
    record_time: str = "1996/08/11 03:12:39",
    note: str = "",
) -> bytes:
    lines = [
        f"Origin Time       {origin}",
        "Lat.              35.770",
        "Long.             -117.599",
        "Depth. (km)       8",
        "Mag.              7.1",
        "Station Code      AKT013",
        "Station Lat.      35.8157",
        "Station Long.     -117.5975",
        "Station Height(m) 34",
        f"Record Time       {record_time}",
        "Sampling Freq(Hz) 100Hz",
        f"Duration Time(s)  {len(counts) / 100:g}",
        f"Dir.              {direction}",
        f"Scale Factor      {scale}",
        f"Max. Acc. (gal)   {peak_gal:.3f}",
        "Last Correction   1996/08/11 03:00:00",
        f"Memo.             {note}".rstrip(),
        *rows([f"{count:8d} " for count in counts], 8),
    ]
    return ("\n".join(lines) + "\n").encode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Counts with an offset; Japanese time, 15 s after the first sample."""
    files = {}
    for channel, code, words in zip(channels, ("EW", "NS", "UD"), ("E-W", "N-S", "U-D"), strict=True):
        counts = np.rint(100.0 * channel.acceleration * 8388608 / 2000.0).astype(int) + 12_345
        peak = 100.0 * float(np.max(np.abs(channel.acceleration)))
        files[f"CLC0011907061219.{code}"] = knet(
            counts,
            peak_gal=peak,
            direction=words,
            origin="2019/07/06 12:19:53",
            record_time="2019/07/06 12:20:13",
            note=NOTE,
        )
    return files
