"""CWB and CWA free field (Taiwan): ``#`` lines, then rows of time [s] and U, N, E [gal] in 4F10.3."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import Record


def cwb(
    columns: Sequence[Sequence[float]],
    rate: float = 50.0,
    first: float = 0.0,
    length: str | None = None,
    start: str = "StartTime(GMT+08): 2018/02/06-23:50:29.000",
    origin: str = "Origin Time(GMT+08): 2018/02/06-23:50:42",
    station: str = "EGF",
    name: str = "Guangfu",
    kind: str = "FBA",
    unit: str = "gal. DCoffset(corr)",
    sequence: str = "Time U(+); N(+); E(+)",
    layout: str = "4F10.3",
) -> bytes:
    """The channels U, N and E, or of `sequence`, accelerations in gal, from `first` [s] on; `length` as stated."""
    count = len(columns[0])
    lines = [
        "#Earthquake Information",
        f"#{origin}",
        "#EpicenterLongitude(E): -117.599",
        "#EpicenterLatitude(N): 35.770",
        "#Depth(km): 8.0",
        "#Magnitude(Mw): 7.1",
        "",
        "#Station Information",
        f"#StationCode: {station}",
        f"#StationName: {name}",
        "#StationLongitude(E): -117.598",
        "#StationLatitude(N): 35.816",
        f"#InstrumentKind: {kind}",
        f"#{start}",
        f"#RecordLength(sec): {length or f'{count / rate:g}'}",
        f"#SampleRate(Hz): {rate:g}",
        f"#AmplitudeUnit:  {unit}",
        *[
            f"#AmplitudeMAX. {letter}: {np.max(values):8.3f}~ {np.min(values):8.3f}"
            for letter, values in zip("UNE", columns, strict=True)
        ],
        f"#DataSequence: {sequence}",
        f"#Data: {layout} ",
    ]
    times = first + np.arange(count) / rate
    lines += ["".join(f"{number:10.3f}" for number in row) for row in zip(times, *columns, strict=True)]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels."""
    east, north, up = (100.0 * channel.acceleration for channel in channels)
    content = cwb(
        [up, north, east],
        rate=1.0 / channels[0].dt,
        start="StartTime(GMT+08): 2019/07/06-11:19:58.000",
        origin="Origin Time(GMT+08): 2019/07/06-11:19:53",
        station="CLC",
        name="China Lake",
        kind=NOTE,
    )
    return {"clc_cwb.dat": content}
