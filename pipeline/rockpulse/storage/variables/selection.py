"""The variables of a selection of records by their mean spectrum."""

from rockpulse.storage.variables import Declared, along, real, text

SELECTION: Declared = {
    **along(
        ("record",),
        factor=real("scale factor of the record"),
        event=text("earthquake of the record"),
    ),
    **along(
        ("record", "period"),
        spectrum=real("5 % damped pseudo-acceleration of the scaled record", "m s^-2"),
    ),
    **along(
        ("period",),
        period=real("period of the oscillator", "s"),
        mean=real("mean of the spectra of the scaled records", "m s^-2"),
        target=real("target spectrum", "m s^-2"),
    ),
}
