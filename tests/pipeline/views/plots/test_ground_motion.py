"""The accelerogram shows the record, its strong half-waves, their impulses and the calibrated ones."""

import numpy as np
import pytest
from drawn import labelled

import rockpulse as rp
from rockpulse.errors import ResultsError
from rockpulse.record.record import Record
from rockpulse.views.plots.ground_motion import accelerogram, motion_of_record, stored_motion


@pytest.fixture(scope="module")
def motion(assessed):
    return stored_motion(assessed, str(assessed["summary"]["record"].values[0]))


@pytest.fixture(scope="module")
def panels(motion):
    return accelerogram(motion)


def test_the_intense_phase_is_shaded_in_every_panel_and_the_units_are_readable(motion, panels):
    phase = float(motion["intense_start"]), float(motion["intense_end"])
    for ax in panels:
        box = labelled(ax)["intense phase"].get_bbox()
        assert (box.x0, box.x1) == pytest.approx(phase)
    low, high = panels[1].get_xlim()
    assert low < phase[0] < phase[1] < high
    assert panels[2].get_xlim() == (low, high)
    words = [ax.get_ylabel().replace("\n", " ") for ax in panels]
    assert words == ["[m/s²]", "conditioned ground acceleration [m/s²]", "signed impulse of the half-wave [m/s]"]
    assert panels[2].get_xlabel() == "time from the first sample [s]"


def test_the_peak_of_the_record_and_the_strong_half_waves_of_its_phase_are_drawn(motion, panels):
    drawn = panels[0].lines[1].get_ydata()  # after the zero line
    acceleration = motion["acceleration"].values
    strongest = int(np.argmax(np.abs(acceleration)))
    assert np.max(np.abs(drawn)) == np.abs(acceleration[strongest])
    assert panels[0].lines[2].get_xydata().tolist() == [[motion["time"].values[strongest], acceleration[strongest]]]
    (words,) = (text.get_text() for text in panels[0].texts)
    assert words == f"PGA {abs(acceleration[strongest]):.3g} m/s² at {motion['time'].values[strongest]:.2f} s"
    assert panels[0].get_xlim() == (0.0, motion["time"].values[-1])
    time, acceleration = panels[1].lines[1].get_data()
    assert np.interp(time, motion["time"].values, motion["acceleration"].values) == pytest.approx(acceleration)
    assert (time[0], time[-1]) == pytest.approx(panels[1].get_xlim(), abs=0.1)
    within = (motion["centroid"] >= motion["intense_start"]) & (motion["centroid"] <= motion["intense_end"])
    size = np.abs(motion["impulse"].values[within.values])
    assert len(panels[1].collections) == np.count_nonzero(size >= 0.5 * size.max()) > 0


def test_impulses_stand_at_their_centroids(motion, panels):
    stems = labelled(panels[2])["impulses"].get_xydata().reshape(-1, 3, 2)
    assert np.all(np.isnan(stems[:, 2]))
    where = np.searchsorted(motion["centroid"].values, stems[:, 1, 0])
    assert np.array_equal(motion["impulse"].values[where], stems[:, 1, 1])
    low, high = panels[2].get_xlim()
    inside = (motion["centroid"].values >= low) & (motion["centroid"].values <= high)
    size = np.abs(motion["impulse"].values)
    assert len(stems) == np.count_nonzero(inside & (size > 0.01 * size.max()))
    assert len(labelled(panels[2])["above half the largest"].get_xdata()) == len(panels[1].collections)
    main = float(motion["main_impulse"])
    assert any(words.startswith(r"$\pm I$ =") for words in labelled(panels[2]))
    assert {main, -main} <= {line.get_ydata()[0] for line in panels[2].lines}


@pytest.mark.sweep
def test_a_record_without_a_sequence_and_results_without_samples_say_so(changed, assessed):
    record = Record(np.sin(np.linspace(0.0, np.pi, 50)), dt=0.02, id="one half-wave")
    drawn = accelerogram(motion_of_record(record))
    assert "No impulse sequence" in drawn[0].figure.get_supxlabel()
    assert not any("pm I" in words for words in labelled(drawn[2]))
    records = assessed["records"].to_dataset().drop_vars(["acceleration", "row_size"])
    with pytest.raises(ResultsError, match=r'\[records\] store = "all"'):
        stored_motion(changed({"/records": records}), str(assessed["summary"]["record"].values[0]))


def test_a_record_gives_the_motion_that_the_results_store(clc, motion):
    fresh = motion_of_record(rp.condition(clc[0]))
    for name in ("acceleration", "impulse", "centroid", "main_impulse", "intense_end"):
        assert np.array_equal(fresh[name].values, motion[name].values)
        assert fresh[name].attrs["units"] == motion[name].attrs["units"]


def test_axes_that_are_given_are_used(motion):
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.subplots(3, 1)
    assert list(accelerogram(motion, axes)) == list(axes)
    assert figure.get_supxlabel() == ""
    assert axes[0].get_title(loc="left") == motion.attrs["record"]
    with pytest.raises(ValueError, match="expected an array of 3 x 1 Axes, got 2"):
        accelerogram(motion, axes[:2])


def test_the_title_tells_the_record_in_words_where_something_is_known_of_it(assessed, clc, motion, panels):
    words = "earthquake of 2019-07-06, station CLC (China Lake, G2 Tower Rd.)"
    assert motion.attrs["words"].startswith(words)
    assert panels[0].figure.get_suptitle().replace("\n", " ").startswith(f"{motion.attrs['record']} {words}")
    assert motion_of_record(clc[0]).attrs["words"] == motion.attrs["words"]
    plain = motion_of_record(Record(motion["acceleration"].values, dt=0.01, id="plain"))
    assert accelerogram(plain)[0].figure.get_suptitle() == "plain"
