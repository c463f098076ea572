"""Frequencies of many bodies from one set of overturning spectra, against one body and one record at a time."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from bursts import packet
from scipy.integrate import quad
from scipy.special import ndtr

import rockpulse as rp
from rockpulse import models
from rockpulse.config.study_settings import HazardSettings
from rockpulse.sequences.design_spectrum import at_blocks
from rockpulse.studies.risk.hazard_files import site_hazards_of
from rockpulse.studies.risk.inventory import curves_in_parts

LAW = rp.PowerLawHazard(k0=2e-3, k=2.0, measure="pgv")
CURVE = rp.HazardCurve("pga", [0.1, 1.0, 4.0], [0.3, 0.02, 1e-3])


@pytest.fixture(scope="module")
def results():
    config = rp.Config(models=rp.ModelSettings(use=("nonlinear",)), uncertainty=rp.UncertaintySettings(spectrum="all"))
    return rp.assess(
        [packet(n, max(n - 1, 0)) for n in range(5)], config, bodies={"wall": models.Block(width=0.4, height=3.0)}
    )


def test_many_bodies_are_read_like_one_and_larger_ones_fall_less_often(results):
    scale = np.linspace(0.8, 3.0, 500)
    many = models.Block(width=0.3 * scale, height=2.4 * scale)
    found = rp.inventory_frequency(results, many, LAW)
    # Not at every step of 0.4 %, at which the lanes of a spectrum change; from 18 to 50 % of the size.
    frequency = found["frequency"].values
    assert np.all(frequency[100:] < frequency[:-100])
    for place in (0, 250, 499):
        one = rp.inventory_frequency(results, models.Block(width=0.3 * scale[place], height=2.4 * scale[place]), LAW)
        for name in found:
            assert found[name].values[place] == pytest.approx(one[name].item(), rel=1e-12, nan_ok=True), name
    # A body of the same shape at a level: half of the mean over records overturns there.
    median, spread = found["median"].values, found["dispersion"].values
    assert np.all(median[100:] > median[:-100])
    assert np.all((spread > 0.05) & (spread < 1.5))


def curves_of_places(folder):
    """OpenQuake's curves of three places, each of another seismicity; the second lies behind the 180th meridian."""
    path = folder / "curves.csv"
    rows = [(13.0, 42.0, 0.3, 0.02), (-179.9, 10.0, 0.2, 0.01), (14.0, 42.5, 0.1, 0.002)]
    head = "# investigation_time=50.0, imt='PGV'\nlon,lat,depth,poe-10,poe-100\n"
    path.write_text(head + "".join(f"{east},{north},0,{low},{high}\n" for east, north, low, high in rows))
    return path


def test_each_body_has_the_hazard_of_its_site_and_ground(results, tmp_path):
    path = curves_of_places(tmp_path)
    sites = np.array([[13.9, 42.5], [13.0, 42.1], [180.0, 10.0], [14.0, 42.5]])
    factors = np.array([1.0, 1.5, 1.0, 1.2])
    hazards = rp.load_site_hazards(path, sites, factors)
    bodies = models.Block(width=[0.35, 0.35, 0.4, 0.35], height=[2.6, 2.6, 3.0, 2.6])
    found = rp.inventory_frequency(results, bodies, hazards)
    for place, (site, factor) in enumerate(zip(sites, factors, strict=True)):
        own = rp.load_hazard(path, tuple(site), factor)
        one = rp.inventory_frequency(results, bodies.take(np.array([place])), own)
        for name in set(one) - {"hazard_distance"}:
            assert found[name].values[place] == pytest.approx(one[name].item(), rel=1e-12, nan_ok=True), name
    assert len(set(found["frequency"].values[[0, 1, 3]])) == 3
    # A tenth of a degree: 6371 km pi/1800 along the meridian, times cos 42.5 or cos 10 along the parallel.
    tenth = 6371e3 * math.pi / 1800.0
    expected = [tenth * math.cos(math.radians(42.5)), tenth, tenth * math.cos(math.radians(10.0)), 0.0]
    assert found["hazard_distance"].values == pytest.approx(expected, abs=5.0)
    assert "4 hazards of pgv in cm/s" in found.attrs["hazard"]
    assert "given for the point nearest to each body, up to 11.1 km away" in found.attrs["hazard_conditions"]
    # With soil factors that differ the curves do not end at the same levels.
    assert math.isnan(found.attrs["covered_low"])


def test_one_hazard_with_a_soil_factor_of_each_body(results):
    body = models.Block(width=[0.35, 0.35], height=[2.6, 2.6])
    both = site_hazards_of(HazardSettings(k0=2e-3, k=2.0, measure="pgv"), None, np.array([1.0, 1.5]), 2, Path())
    frequency = rp.inventory_frequency(results, body, both)["frequency"].values
    # A power law in levels 1.5 times as high: rates 1.5^k times as large.
    assert frequency[1] == pytest.approx(1.5**2 * frequency[0], rel=1e-9)


def test_sites_without_a_curve_are_refused(results, tmp_path):
    path = curves_of_places(tmp_path)
    with pytest.raises(rp.ConfigError, match=r"nearest to the site 42 E 13 N is .*expected one within 50 km"):
        rp.load_site_hazards(path, [[13.0, 42.0], [42.0, 13.0]])
    with pytest.raises(
        rp.ConfigError, match=r"sites: expected a longitude and a latitude \[degrees\] for each body, got shape \(2,\)"
    ):
        rp.load_site_hazards(path, [13.0, 42.0])
    with pytest.raises(rp.ConfigError, match=r"got \[13.0, nan\] for body 2"):
        rp.load_site_hazards(path, [[13.0, 42.0], [13.0, math.nan]])
    with pytest.raises(rp.ConfigError, match=r"sites: expected a longitude and a latitude .* got shape"):
        rp.load_site_hazards(path, np.zeros((0, 2)))
    with pytest.raises(rp.ConfigError, match=r"sites: expected .* got \[\['a', 'b'\]\]"):
        rp.load_site_hazards(path, [["a", "b"]])
    with pytest.raises(rp.ConfigError, match="soil factor: expected one positive number, or one for each of 1"):
        rp.load_site_hazards(path, [[13.0, 42.0]], [1.0, 1.2])
    (tmp_path / "one.csv").write_text("pgv [cm/s],rate\n10,1e-2\n40,1e-3\n")
    with pytest.raises(rp.ConfigError, match="one hazard curve without coordinates, so the sites of the bodies"):
        rp.load_site_hazards(tmp_path / "one.csv", [[13.0, 42.0]])
    one = rp.load_site_hazards(path, [[13.0, 42.0]])
    with pytest.raises(rp.ConfigError, match="hazard: expected one hazard for each of 2 bodies, got 1"):
        rp.inventory_frequency(results, models.Block(width=[0.4, 0.4], height=[3.0, 3.1]), one)
    with pytest.raises(rp.ConfigError, match="give a file with the hazard curves of several sites"):
        site_hazards_of(HazardSettings(k0=2e-3, k=2.0), np.array([[13.0, 42.0]]), None, 1, Path())


def test_hazards_of_sites_have_one_measure_and_a_number_for_each_body():
    distance = np.zeros(2)
    with pytest.raises(rp.ConfigError, match=r"expected one measure in one unit, found pga in m/s2, pgv in m/s"):
        rp.SiteHazards((LAW, CURVE), np.array([0, 1]), distance)
    with pytest.raises(rp.ConfigError, match="found no hazard"):
        rp.SiteHazards((), np.array([], int), np.zeros(0))
    with pytest.raises(rp.ConfigError, match="of_body, distance: expected for each body a number from 0 to 0"):
        rp.SiteHazards((LAW,), np.array([0, 1]), distance)


KINKED = rp.HazardCurve("pgv", [0.1, 0.2, 0.25, 2.0], [2e-2, 1e-2, 1e-4, 1e-6])
STEEP = rp.HazardCurve("pga", [0.5, 1.6, 1.8, 4.0], [2e-2, 1e-2, 1e-4, 1e-6])


@pytest.mark.sweep
@pytest.mark.parametrize("hazard", [KINKED, STEEP])
def test_the_sum_over_a_hazard_is_exact_between_its_bends_and_from_the_uplift_on(results, hazard):
    """By adaptive quadrature of the same P, straight between stored levels, with the bends of both as ends."""
    body = models.Block(width=[0.35], height=[2.6]).lanes(1)
    spectra, summary = results["spectra"].to_dataset(), results["summary"].to_dataset()
    ((_, curves),) = curves_in_parts(spectra, summary, body, hazard.measure)
    floor = curves.floor[0] if hazard.measure == "pga" else -math.inf
    of_record = []
    for at, chance in zip(curves.at[0], curves.probability[0], strict=True):

        def chance_at(u, at=at, chance=chance):
            return float(np.interp(u, at, chance, right=1.0))

        start, top = max(at[0], floor), max(at[-1], floor)
        ends = np.unique([start, top, *at[(at > start) & (at < top)], *(k for k in hazard.knots if start < k < top)])
        pieces = (
            quad(lambda u: chance_at(u) * math.exp(hazard.log_density(np.array(u))), low, high, epsrel=1e-10)[0]
            for low, high in itertools.pairwise(ends.tolist())
        )
        of_record.append(sum(pieces) + float(hazard.rate(math.exp(top))))
    events = np.unique(summary["event"].values, return_inverse=True)[1]
    expected = np.mean([np.mean(np.array(of_record)[events == one]) for one in range(events.max() + 1)])
    assert rp.inventory_frequency(results, body, hazard)["frequency"].item() == pytest.approx(expected, rel=1e-8)


def test_what_the_spectra_do_not_stand_for_is_nan_and_gaps_are_reported(results):
    bodies = models.Block(width=[0.4, 1.0], height=[3.0, 1.0], restitution=[0.9, 0.9])
    assert np.isnan(rp.inventory_frequency(results, bodies, LAW)["frequency"].values).tolist() == [False, True]
    wall = models.Block(width=[0.4], height=[3.0])
    for restitution in ((0.95, 1.05), (0.97, 0.98), (0.9, 0.95, 1.0)):
        known = rp.UncertaintySettings(spectrum="all", restitution=restitution)
        config = rp.Config(models=rp.ModelSettings(use=("nonlinear",)), uncertainty=known)
        one = rp.assess([packet(0, 0)], config, bodies={"wall": wall.lane(0)})
        if restitution == (0.95, 1.05):
            assert np.isnan(rp.inventory_frequency(one, wall, LAW)["frequency_low"].item())
        else:
            with pytest.raises(rp.ResultsError, match=r"no values at the C of these bodies, .* such as \[0.95, 1.05\]"):
                rp.inventory_frequency(one, wall, LAW)


def test_what_cannot_be_answered_is_refused(results):
    body = models.Block(width=[0.4], height=[3.0])
    with pytest.raises(rp.ConfigError, match="expected one of pga or pgv"):
        rp.inventory_frequency(results, body, rp.PowerLawHazard(1e-3, 2.0, "sa_1"))
    with pytest.raises(rp.ConfigError, match="expected a positive time"):
        rp.inventory_frequency(results, body, LAW, years=-1.0)
    bare = rp.assess([packet(0, 0)], rp.Config(models=rp.ModelSettings(use=("sequence",))), bodies={"a": body.lane(0)})
    with pytest.raises(rp.ResultsError, match="contain no overturning spectra"):
        rp.inventory_frequency(bare, body, LAW)


def mean_capacity(spectrum, body):
    """The mean scale factor of a body, g tan(alpha)/(p S), from the spectrum of a record."""
    axes = spectrum["p"].values, spectrum["restitution"].values
    own = np.exp(at_blocks(body, *axes, np.log(spectrum["spectrum"].values)))
    return (body.gravity * np.tan(body.alpha_c) / body.p / own)[0]


def by_hand(results, body, hazard, low, high, relative=False):
    """The integral of P |dH| between levels, or factors on each record, with P read on a fine grid: the mean."""
    summary, spectra = results["summary"].to_dataset(), results["spectra"].to_dataset()
    by_event: dict[str, list[float]] = {}
    for name in spectra["record"].values:
        one = spectra.sel(record=name)
        capacity = mean_capacity(one, body)
        probability = at_blocks(body, one["p"].values, one["restitution"].values, one["probability"].values)[0]
        own = float(summary[hazard.measure].sel(record=name))
        ends = (low * own, high * own) if relative else (low, high)
        u = np.linspace(math.log(max(ends[0], 1e-4)), math.log(min(ends[1], 1e4)), 40_001)
        middle = 0.5 * (u[1:] + u[:-1])
        chance = np.interp(
            middle - math.log(own * capacity), np.log(one["level"].values), probability, left=0.0, right=1.0
        )
        value = float(np.sum(chance * -np.diff(np.exp(hazard.log_rate(u)))))
        by_event.setdefault(str(summary["event"].sel(record=name).values), []).append(value)
    return np.mean([np.mean(values) for values in by_event.values()])


def test_nothing_overturns_below_the_acceleration_that_lifts(results):
    body = models.Block(width=[0.35], height=[2.6])
    lifting = float(body.gravity * np.tan(body.alpha_c[0]))
    steep = rp.PowerLawHazard(k0=1e-3, k=6.0)
    found = rp.inventory_frequency(results, body, steep)["frequency"].item()
    assert found == pytest.approx(by_hand(results, body, steep, lifting, 1e4), rel=3e-3)
    assert found < 0.99 * by_hand(results, body, steep, 1e-4, 1e4)


@pytest.mark.sweep
def test_the_shares_beyond_the_curve_and_beyond_the_factors_are_reported(results):
    body = models.Block(width=[0.35], height=[2.6])
    curve = rp.HazardCurve("pgv", [0.25, 0.5], [8e-3, 2e-3])
    found = rp.inventory_frequency(results, body, curve)
    whole = by_hand(results, body, curve, 1e-4, 1e4)
    assert found["frequency"].item() == pytest.approx(whole, rel=5e-4)
    assert found["frequency_low"].item() < found["frequency"].item() < found["frequency_high"].item()
    assert found["probability"].item() == pytest.approx(1.0 - math.exp(-50.0 * found["frequency"].item()))
    assert found["below"].item() == pytest.approx(by_hand(results, body, curve, 1e-4, 0.25) / whole, abs=2e-3)
    assert found["above"].item() == pytest.approx(by_hand(results, body, curve, 0.5, 1e4) / whole, abs=2e-3)
    inside = by_hand(results, body, curve, 0.25, 4.0, relative=True) / whole
    assert found["far"].item() == pytest.approx(1.0 - inside, abs=2e-3)


def test_the_fragility_of_a_free_body_is_that_of_the_spectra(results):
    """At the level x a record of PGV m acts with x/m: S x/m against g tan(alpha)/p.

    Five records of four earthquakes, which weigh alike: the first two are of one.
    """
    body = models.Block(width=[0.35, 5.0], height=[2.6, 5.0])
    levels = np.array([0.2, 0.4, 0.8])
    found = rp.free_body_fragility(results, body, levels, "pgv")
    assert np.isnan(found["probability"].values[1]).all()
    summary, spectra = results["summary"].to_dataset(), results["spectra"].to_dataset()
    body = body.lanes(2).take(np.array([0]))
    ratio, chance = [], []
    for name in spectra["record"].values:
        one = spectra.sel(record=name)
        capacity = mean_capacity(one, body)
        own = float(summary["pgv"].sel(record=name))
        probability = at_blocks(body, one["p"].values, one["restitution"].values, one["probability"].values)[0]
        ratio.append(-math.log(capacity * own))
        chance.append(np.interp(np.log(levels / own / capacity), np.log(one["level"].values), probability))
    weights = np.array([0.125, 0.125, 0.25, 0.25, 0.25])
    middle = weights @ ratio
    deviation = math.sqrt(weights @ (np.array(ratio) - middle) ** 2)
    assert found["dispersion"].values[0] == pytest.approx(deviation, rel=1e-3)
    assert found["median"].values[0] == pytest.approx(math.exp(-middle), rel=1e-3)
    assert found["lognormal"].values[0] == pytest.approx(ndtr((np.log(levels) + middle) / deviation), abs=2e-3)
    assert found["probability"].values[0] == pytest.approx(weights @ np.array(chance), abs=2e-3)
    # 9.80665 0.35/2.6 = 1.32 m/s2 lifts it.
    pga = rp.free_body_fragility(results, body, [1.3, 1.34])
    assert (pga["lognormal"].values[0] > 0.0).tolist() == [False, True]
    with pytest.raises(rp.ConfigError, match="measure: expected one of pga or pgv"):
        rp.free_body_fragility(results, body, levels, "si")
    with pytest.raises(rp.ConfigError, match="levels: expected positive numbers"):
        rp.free_body_fragility(results, body, [0.0])
