"""ASA 2.0 (Mexico: UNAM, CIRES)."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, retold
from rockpulse.record.record import Record

_RULE, _DASHES = "=" * 80, "---------+" * 8


def asa(
    values: np.ndarray,
    words: Sequence[str] = ("V", "N90E", "N00E"),
    headings: Sequence[str] | None = None,
    rate: Sequence[float] = (250, 250, 250),
    intervals: Sequence[float] | None = None,
    counts: Sequence[int] | None = None,
    peaks: Sequence[float] | None = None,
    station: str = "IDEI PATIO 5",
    code: str = "CUP5",
    place: str = "Caseta Patio del Instituto de",
    date: str = "2004/01/01",
    origin: str = "23:58:02.7",
    start: str = "00:00:01    ",
    start_key: str = "HORA DE LA PRIMERA MUESTRA (GMT)",
    unit: str = "Gal (cm/s/s)",
    layout: str = "3F10.3",
    field: str = "{:10.3f}",
    quality: str = "Registro digital completo con tiempo absoluto correcto",
    institute: str = "INSTITUTO DE INGENIERIA, UNAM",
    encoding: str = "ascii",
    end: str = "\r\n",
) -> bytes:
    """Rows of a (n, channels) table [gal]; in an encoding other than ASCII the header has its accents."""

    def listed(items: Sequence[object]) -> str:
        return "".join(f"/{item}" for item in items)

    def keyed(*pairs: tuple[str, str]) -> list[str]:
        return [f"{key:<39}: {value}".rstrip(" ") for key, value in pairs]

    given = counts or [len(values)] * len(words)
    columns = [values[:count, index] for index, count in enumerate(given)]
    largest = [column[np.argmax(np.abs(column))] for column in columns] if peaks is None else peaks
    steps = [1.0 / one for one in rate] if intervals is None else intervals
    blank = [("", "")]
    lines = [
        "*" * 86,
        f"                       {institute}",
        "                  Coordinacion de Instrumentacion Sismica",
        "  Ciudad Universitaria",
        " Tel.",
        "*" * 86,
        "ARCHIVO ESTANDAR DE ACELERACION:",
        *keyed(
            ("VERSION DEL FORMATO", "2.0"),
            ("NOMBRE DEL ARCHIVO", "CUP50401.012"),
            ("FECHA Y HORA DE CREACION", "Mon Jan 05 12:12:37 2004"),
            ("REF. CATALOGO ACELEROGRAMAS, SMIS 1995", "REGISTRO NO.      /PAG."),
        ),
        "",
        "",
        _RULE,
        "DATOS DE LA ESTACION:",
        *keyed(
            ("NOMBRE DE LA ESTACION", station),
            ("CLAVE DE LA ESTACION", code),
            ("LOCALIZACION DE LA ESTACION", place),
            *blank * 4,
            ("COORDENADAS DE LA ESTACION", "19.33024 LAT. N"),
            ("", "99.181076 LONG. W"),
            ("ALTITUD (msnm)", "2240"),
            ("TIPO DE SUELO", "ROCA BASALTICA"),
            *blank * 2,
            ("INSTITUCION RESPONSABLE", institute),
            *blank,
        ),
        "",
        _RULE,
        "DATOS DEL ACELEROGRAFO: ",
        *keyed(
            ("MODELO DEL ACELEROGRAFO", "IDS-3602A"),
            ("NUMERO DE SERIE DEL ACELEROGRAFO", "371"),
            ("NUMERO DE CANALES", str(len(words))),
            ("ORIENTACION C1-C6 (rumbo;orientacion)", listed(words[:6])),
            ("ORIENTACION C7-C12 (rumbo;orientacion)", listed(words[6:])),
            ("VEL. DE MUESTREO, C1-C6 (muestras/s)", listed([f"{one:g}" for one in rate[:6]])),
            ("VEL. DE MUESTREO, C7-C12 (muestras/s)", listed([f"{one:g}" for one in rate[6:]])),
            ("ESC. COMPLETA DE SENSORES, C1-C6, (g)", "/2/2/2"),
            ("ESC. COMPLETA DE SENSORES, C7-C12 (g)", ""),
            ("FREC. NAT. DE SENSORES, C1-C6, (Hz)", "/48.0/52.0/53.0"),
            ("FREC. NAT. DE SENSORES, C7-C12 (Hz)", ""),
            ("AMORTIGUAMIENTO DE SENSORES, C1-C6", "/0.75/0.60/0.70"),
            ("AMORTIGUAMIENTO DE SENSORES, C7-C12", ""),
            ("INTERVALO DE MUESTREO, C1-C6 (s)", listed([f"{one:g}" for one in steps[:6]])),
            ("INTERVALO DE MUESTREO, C7-C12 (s)", listed([f"{one:g}" for one in steps[6:]])),
            ("UMBRAL DE DISPARO, C1-C6 (Gal)", "/1/1/1"),
            ("UMBRAL DE DISPARO, C7-C12 (Gal)", ""),
            ("MEMORIA DE PREEVENTO (s)", "20"),
            ("TIEMPO DE POSEVENTO (s)", "30"),
        ),
        "",
        "",
        _RULE,
        "DATOS DEL SISMO:",
        *keyed(
            ("FECHA DEL SISMO [GMT]", date),
            ("HORA EPICENTRO (GMT)", origin),
            ("MAGNITUD(ES)", "/Mb=5.2/Ms=5.8"),
            ("COORDENADAS DEL EPICENTRO", "17.30 LAT. N"),
            ("", "101.36 LONG. W"),
            ("PROFUNDIDAD FOCAL (Km)", "14"),
            ("FUENTE DE LOS DATOS EPICENTRALES", "SSN"),
            *blank,
        ),
        "",
        _RULE,
        "DATOS DE ESTE REGISTRO:",
        *keyed(
            (start_key, start),
            ("EXACTITUD DEL TIEMPO (s)", "0.5  "),
            (
                "DURACION DEL REGISTRO (s), C1-C6",
                listed([f"{n / r:.2f}" for n, r in zip(given, rate, strict=True)][:6]),
            ),
            ("DURACION DEL REGISTRO (s), C7-C12", ""),
            ("NUM. TOTAL DE MUESTRAS, C1-C6", listed(given[:6])),
            ("NUM. TOTAL DE MUESTRAS, C7-C12", listed(given[6:])),
            ("ACEL. MAX.(Gal), C1-C6", listed([f"{one:.2f}" for one in largest[:6]])),
            ("ACEL. MAX., C1-C6, EN LA MUESTRA", listed([1 + int(np.argmax(np.abs(one))) for one in columns[:6]])),
            ("ACEL. MAX.(Gal), C7-C12", listed([f"{one:.2f}" for one in largest[6:]])),
            ("ACEL. MAX., C7-C12,EN LA MUESTRA", ""),
            ("UNIDADES DE LOS DATOS", unit),
            ("FACTOR DE DECIMACION", "1"),
            ("FORMATO DATOS (FORTRAN,10 campos/dato)", layout),
        ),
        "",
        "",
        _RULE,
        "CALIDAD DEL ACELEROGRAMA:",
        quality,
        "",
        "",
        _RULE,
        "COMENTARIOS:",
        *[""] * 14,
        _RULE,
        "DATOS DE ACELERACION:",
        _DASHES,
        "".join(f"{f'CANAL-{number}':>10}" for number in range(1, len(words) + 1)),
        "".join(f"{word:>10}" for word in headings or words),
        _DASHES,
    ]
    if encoding != "ascii":
        lines = [line.replace("ACION", "ACIÓN").replace("ESTANDAR", "ESTÁNDAR") for line in lines]
    for row, line in enumerate(values):
        fields = (field.format(value) if row < given[index] else " " * 10 for index, value in enumerate(line))
        lines.append("".join(fields))
    return (end.join(lines) + end).encode(encoding)


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """The three channels, V, N90E, N00E."""
    start = channels[0].start_time
    assert start is not None
    east, north, up = (100.0 * channel.acceleration for channel in channels)
    content = asa(
        np.column_stack([up, east, north]),
        rate=(100, 100, 100),
        station="China Lake",
        code="CLC",
        place=NOTE,
        institute=NOTE,
        date="2019/07/06",
        origin="03:19:53.0",
        start=f"{start:%H:%M:%S.%f}",
    )
    content = retold(
        content,
        ("19.33024 LAT. N", "35.81574 LAT. N"),
        ("99.181076 LONG. W", "117.59751 LONG. W"),
        ("ROCA BASALTICA", ""),
        ("/Mb=5.2/Ms=5.8", "/Mw=7.1"),
        ("17.30 LAT. N", "35.770 LAT. N"),
        ("101.36 LONG. W", "117.599 LONG. W"),
        ("PROFUNDIDAD FOCAL (Km)                 : 14", "PROFUNDIDAD FOCAL (Km)                 : 8"),
    )
    return {"clc_asa.061": content}
