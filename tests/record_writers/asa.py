"""ASA 2.0 (Mexico: UNAM, CIRES)."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import shipped
from rockpulse.record.record import Record

#: The sample whose header all files have.
SAMPLE = "clc_asa.061"
_DASHES = "---------+" * 8


def asa(
    values: np.ndarray,
    words: Sequence[str] = ("V", "N90E", "N00E"),
    headings: Sequence[str] | None = None,
    rate: Sequence[float] = (250, 250, 250),
    intervals: Sequence[float] | None = None,
    counts: Sequence[int] | None = None,
    date: str = "2004/01/01",
    origin: str = "23:58:02.7",
    start: str = "00:00:01    ",
    start_key: str = "HORA DE LA PRIMERA MUESTRA (GMT)",
    unit: str = "Gal (cm/s/s)",
    layout: str = "3F10.3",
    quality: str = "Registro digital completo con tiempo absoluto correcto",
    encoding: str = "ascii",
) -> bytes:
    """Rows of a (n, channels) table [gal]; in an encoding other than ASCII the header has its accents."""
    given = counts or [len(values)] * len(words)
    columns = [values[:count, index] for index, count in enumerate(given)]
    largest = [int(np.argmax(np.abs(column))) for column in columns]
    peaks = [f"{column[place]:.2f}" for column, place in zip(columns, largest, strict=True)]
    steps = [1.0 / one for one in rate] if intervals is None else intervals

    def listed(key: str, items: Sequence[object]) -> dict[str, str]:
        """The entry of the first six channels, and that of the others."""
        halves = {"C1-C6": items[:6], "C7-C12": items[6:]}
        return {key.format(half): "".join(f"/{item}" for item in own) for half, own in halves.items()}

    facts = {
        "NUMERO DE CANALES": str(len(words)),
        **listed("ORIENTACION {} (rumbo;orientacion)", words),
        **listed("VEL. DE MUESTREO, {} (muestras/s)", [f"{one:g}" for one in rate]),
        **listed("INTERVALO DE MUESTREO, {} (s)", [f"{one:g}" for one in steps]),
        "FECHA DEL SISMO [GMT]": date,
        "HORA EPICENTRO (GMT)": origin,
        "HORA DE LA PRIMERA MUESTRA (GMT)": start,
        **listed("DURACION DEL REGISTRO (s), {}", [f"{n / one:.2f}" for n, one in zip(given, rate, strict=True)]),
        **listed("NUM. TOTAL DE MUESTRAS, {}", given),
        **listed("ACEL. MAX.(Gal), {}", peaks),
        **listed("ACEL. MAX., {}, EN LA MUESTRA", [1 + place for place in largest]),
        "UNIDADES DE LOS DATOS": unit,
        "FORMATO DATOS (FORTRAN,10 campos/dato)": layout,
    }
    lines = []
    for line in shipped(SAMPLE).decode().partition("   CANAL-1")[0].splitlines():
        key = line[:39].rstrip()
        lines.append(f"{key:<39}: {facts[key]}".rstrip(" ") if key in facts else line)
    text = "\n".join(lines).replace("HORA DE LA PRIMERA MUESTRA (GMT)", start_key)
    text = text.replace("Registro digital completo con tiempo absoluto correcto", quality)
    if encoding != "ascii":
        text = text.replace("ACION", "ACIÓN").replace("ESTANDAR", "ESTÁNDAR")
    table = [
        "".join(f"{f'CANAL-{number}':>10}" for number in range(1, len(words) + 1)),
        "".join(f"{word:>10}" for word in headings or words),
        _DASHES,
    ]
    for row, line in enumerate(values):
        table.append("".join(f"{one:10.3f}" if row < given[at] else " " * 10 for at, one in enumerate(line)))
    return ("\r\n".join([*text.splitlines(), *table]) + "\r\n").encode(encoding)


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """The three channels, V, N90E, N00E."""
    east, north, up = (100.0 * channel.acceleration for channel in channels)
    table = np.column_stack([up, east, north])
    return {SAMPLE: asa(table, rate=(100, 100, 100), date="2019/07/06", origin="03:19:53.0", start="03:19:58.000000")}
