"""Every kind is drawn from its file, and what does not fit is refused with what would."""

import numpy as np
import pytest
import xarray as xr
from drawn import in_legend, small_print
from matplotlib.axes import Axes
from matplotlib.text import Text

import rockpulse as rp
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.storage.hdf5.atomic import ASSESSMENT
from rockpulse.storage.variables.probability import SPECTRUM, SPECTRUM_AXES
from rockpulse.views.plots.drawing import DRAWERS, MARCHED_RATES, draw, has_spectra
from rockpulse.views.plots.ground_motion import stored_record
from rockpulse.views.plots.picture_kinds import KINDS, OPTIONS, kind_list
from rockpulse.views.plots.selection import one_name, settings_of
from rockpulse.views.shared.words import writing

COLUMN = "column of $one$ piece"

#: Kinds whose pictures take longest to make.
SLOWER = ("rocking-spectrum", "limit-accelerogram", "rotation-history", "spectrum")


def spectra():
    """Made-up spectra of two records, over p and two restitutions."""
    p, shape = np.geomspace(0.5, 8.0, 5), (2, 5, 2)
    names = ("spectrum", "spectrum_low", "spectrum_high")
    values = {
        name: SPECTRUM[name].variable(np.full(shape, level), ("record", "p", "restitution"))
        for name, level in zip(names, (0.5, 0.4, 0.6), strict=True)
    }
    axes = {name: SPECTRUM_AXES[name].variable(own) for name, own in (("p", p), ("restitution", [0.9, 0.95]))}
    return xr.Dataset(values, axes)


@pytest.mark.sweep
def test_the_spectra_of_few_records_are_computed_if_the_file_does_not_hold_them(assessed, changed, monkeypatch):
    name = str(assessed["summary"]["record"].values[0])
    (ax,) = draw(assessed, "spectrum", record=name, restitution=0.9).axes
    curve = next(line for line in ax.lines if line.get_label() == "spectrum of the record")
    expected = rp.overturning_spectrum(stored_record(assessed, name), MARCHED_RATES, [0.9])
    assert curve.get_ydata() == pytest.approx(expected["spectrum"].values[:, 0])
    (both,) = draw(assessed, "spectrum", restitution=0.9).axes
    assert any(line.get_ydata() == pytest.approx(expected["spectrum"].values[:, 0]) for line in both.lines)
    chance = assessed["summary"]["overturning_probability"].values
    known = changed(overturning_probability=np.full_like(chance, 0.2))
    assert [has_spectra(tree) for tree in (assessed, known)] == [False, True]
    monkeypatch.setattr("rockpulse.views.plots.drawing.MARCHED", 1)
    assert not has_spectra(known)
    assert draw(assessed, "spectrum", record=name).axes
    with pytest.raises(ResultsError, match=r'of its 2 records, .* at most 1 .* \[uncertainty\] spectrum = "all"'):
        draw(assessed, "spectrum")


def test_records_of_zeros_have_no_spectrum(assessed, changed):
    still = assessed["records"].to_dataset()
    still["acceleration"] = 0.0 * still["acceleration"]
    with pytest.raises(ResultsError, match="the acceleration is zero throughout"):
        draw(changed({"/records": still}), "spectrum")


@pytest.mark.sweep
def test_the_spectrum_is_that_of_the_record_with_the_bodies(assessed, changed):
    tree = changed({"/spectra": spectra().assign_coords(record=assessed["summary"]["record"].values)})
    figure = draw(tree, "spectrum", record=str(assessed["summary"]["record"].values[1]), restitution=0.9)
    (ax,) = figure.axes
    curve = next(line for line in ax.lines if line.get_label() == "spectrum of the record")
    assert curve.get_ydata().tolist() == [0.5] * 5
    places = sorted(line.get_xdata()[0] for line in ax.lines if len(line.get_xdata()) == 1)
    assert set(places) == set(assessed["summary"]["p"].values)
    assert draw(tree, "spectrum").get_suptitle().startswith("2 records")
    with pytest.raises(ConfigError, match="one C"):
        draw(tree, "spectrum", restitution="housner")


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=pytest.mark.sweep if kind in SLOWER else ())
        for kind, row in KINDS.items()
        if ASSESSMENT in row.files
    ],
)
def test_kinds_of_an_assessment_hold_long_names(assessed, changed, kind):
    """Whole, as wide as the page, with the name of what was chosen, and in words what is known of the record."""
    parts = {name: assessed[name].to_dataset() for name in ("summary", "records")}
    names = {"record": [f"NETWORK_{k}.{'THE_LONG_NAME_OF_A_STATION_' * 5}.HNE@2019" for k in range(2)]}
    blocks = {"block": ["wall of the church, NORTH TRANSEPT, upper part, after the works, variant A" * 2, COLUMN]}
    tree = changed(
        {
            "/summary": parts["summary"].assign_coords(names | blocks),
            "/records": parts["records"].assign_coords(names),
            "/spectra": spectra().assign_coords(names),
        }
    )
    chosen = {"record": names["record"][0], "block": blocks["block"][0]}
    options = {name: chosen[name] for name in KINDS[kind].options if name in chosen}
    if kind == "overturning-map":
        options.pop("block")
    figure = draw(tree, kind, **options)
    figure.draw_without_rendering()
    page = figure.bbox.padded(5.0)  # matplotlib before 3.11 sets a title of seven lines 4 pixels above the page
    boxes = {text.get_text(): text.get_window_extent() for text in figure.findobj(Text) if text.get_text()}
    outside = [text for text, box in boxes.items() if not (page.contains(*box.min) and page.contains(*box.max))]
    assert [text for text in outside if text in _seen(figure)] == []
    words = " ".join(" ".join(boxes).split())
    assert all(name[:20] in words for name in options.values())
    told = "earthquake of 2019-07-06, station CLC" in words
    assert told == (kind in ("accelerogram", "limit-accelerogram", "rotation-history"))
    assert figure.get_size_inches()[0] == 6.3


def _seen(figure):
    """Texts but those of ticks beyond the limits of their axis."""
    hidden = set()
    for ax in figure.findobj(Axes):
        for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            low, high = min(limits), max(limits)
            hidden |= {tick.label1.get_text() for tick in axis.get_major_ticks() if not low <= tick.get_loc() <= high}
    return {text.get_text() for text in figure.findobj(Text) if text.get_visible()} - hidden


def test_a_picture_is_drawn_in_the_language_that_is_written(assessed):
    with writing("it"):
        (ax,) = draw(assessed, "critical-scale", block="wall", model=["sequence", "nonlinear"]).axes
        assert {"0,5", "1", "10"} < {ax.xaxis.get_major_formatter()(value) for value in ax.get_xticks()}
    assert (
        ax.figure.get_suptitle() == "wall: per ciascuna registrazione, fattore di scala per cui si ha il\nribaltamento"
    )
    assert in_legend(ax) == ["a sequenza di impulsi", "non lineare"]
    assert ax.get_xlabel() == "fattore di scala minimo per cui si ha il ribaltamento [-]"
    assert small_print(ax).startswith("Registrazioni in ordine secondo il modello non lineare.")


def test_the_tables_agree():
    assert DRAWERS.keys() == KINDS.keys()
    assert {option for row in KINDS.values() for option in row.options} == OPTIONS.keys()
    assert (OPTIONS["record"], OPTIONS["limit_state"]) == ("--record", "--limit-state")
    words = kind_list()
    assert all(name in words and row.command in words for name, row in KINDS.items())


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("rotations-history", {}, r'did you mean "rotation-history"\? There are: '),
        ("fragility", {}, "expected a file of 'rockpulse fragility', found an assessment file"),
        ("accelerogram", {"block": "wall"}, r"has no option block; its options: record \(--record\)"),
        ("accelerogram", {"record": "CI.CLC..HN"}, r"the nearest: CI\.CLC.*; there are: CI\.CLC"),
        ("accelerogram", {}, "expected the name of one of 2 records"),
        (
            "accelerogram",
            {"record": "CI.CLC*"},
            r"matches 2 .*, but the picture shows only one; choose among: CI\.CLC.*, CI\.CLC",
        ),
        ("critical-scale", {"block": "xyz"}, "there are: wall"),
        ("critical-scale", {"block": "wall", "case": 2}, "from 1 to 1, got 2"),
        ("overturning-map", {"block": "wall", "model": ["linear", "nonlinear"]}, "expected one model"),
        ("rocking-spectrum", {"record": "*90@*", "restitution": 1.5}, "restitution: expected a number from 0 to 1"),
    ],
)
def test_what_does_not_fit_is_refused_with_what_would(assessed, kind, options, message):
    with pytest.raises((ConfigError, ResultsError), match=message):
        draw(assessed, kind, **options)


def test_a_pattern_does_that_one_name_meets_and_of_many_the_nearest_are_named(assessed):
    summary = assessed["summary"].to_dataset()
    second = str(summary["record"].values[1])
    assert one_name(summary, "record", f"?{second[1:-7]}*") == second
    figure = draw(assessed, "critical-scale", block="wal?", model=["nonl*"])
    assert in_legend(figure.axes[0]) == ["nonlinear"]
    summary = assessed["summary"].to_dataset()
    many = summary.isel(record=np.zeros(30, dtype=int)).assign_coords(record=[f"record {k}" for k in range(30)])
    with pytest.raises(ResultsError, match=r"nearest: record 17.*; there are 30 \(rockpulse inspect --records\)"):
        one_name(many, "record", "recrd 17")
    assert one_name(many.assign_coords(record=[f"a[{k}]*" for k in range(30)]), "record", "a[1]*") == "a[1]*"


def test_units_of_single_files_are_part_of_the_stored_section():
    given = rp.RecordSettings(files=[rp.FileSettings(match="columns.txt", units="g")])
    tree = xr.DataTree(xr.Dataset(attrs={"configuration": rp.Config(records=given).as_text()}))
    assert settings_of(tree, rp.RecordSettings) == given
