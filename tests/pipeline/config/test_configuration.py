"""The configuration: defaults, strictness, the words of its messages, and the way there and back."""

import dataclasses
import glob
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rockpulse as rp
from rockpulse import BlockSettings
from rockpulse.commands.init_config import config_template
from rockpulse.config.configuration import SECTIONS, Config, config_from_text, load_config
from rockpulse.config.settings import parse_demand_option
from rockpulse.errors import ConfigError
from rockpulse.record.record import STANDARD_GRAVITY

TEMPLATE = config_template()
SITE = Path(__file__).parents[3] / "data" / "samples" / "site.toml"


@pytest.fixture
def load(tmp_path):
    def load(text):
        path = tmp_path / "site.toml"
        path.write_text(text, encoding="utf-8")
        return load_config(path)

    return load


def test_defaults_are_those_of_the_template():
    found = config_from_text(TEMPLATE)
    assert dataclasses.replace(found, bodies=()) == Config()
    assert found.bodies == (BlockSettings(name="block", width=0.6, height=2.4),)


@pytest.mark.parametrize("text", [TEMPLATE, SITE.read_text(encoding="utf-8")], ids=["template", "site"])
def test_every_key_is_shown_and_commented(text):
    for name, section in {**SECTIONS, "block": BlockSettings}.items():
        heading = "[[block]]" if name == "block" else f"[{name}]"
        part = text.partition(heading)[2].partition("\n[")[0]
        inner = [field.metadata["entries"] for field in dataclasses.fields(section) if "entries" in field.metadata]
        assert all(f"# {cls.heading}" in part for cls in inner), heading
        for field in (field for one in (section, *inner) for field in dataclasses.fields(one)):
            shown = re.search(rf"^(# )?{field.name} = .*#|^# {field.name} = ", part, re.M)
            assert shown or "entries" in field.metadata, (heading, field.name)


@pytest.mark.parametrize("name", SECTIONS)
def test_every_allowed_word_is_in_the_template(name):
    part = TEMPLATE.partition(f"[{name}]")[2].partition("\n[")[0]
    for field in dataclasses.fields(SECTIONS[name]):
        for word in field.metadata["values"].words:
            assert f'"{word}"' in part, (field.name, word)


def test_the_sample_has_four_bodies_one_of_them_no_rectangle():
    blocks = load_config(SITE).bodies
    assert len(blocks) >= 4
    assert any(block.p is not None for block in blocks)
    for block in blocks:
        assert block.block().slenderness > 1.0


def test_paths_count_from_the_folder_of_the_file(load, tmp_path):
    config = load('[records]\npaths = ["a/*.AT2", "/abs/b.smc"]')
    assert config.record_paths() == [tmp_path / "a/*.AT2", Path("/abs/b.smc")]
    assert str(tmp_path) not in config.as_text()


def test_the_folder_of_the_file_is_no_pattern_whatever_its_name(tmp_path):
    folder = tmp_path / "site [old]"
    folder.mkdir()
    for name in ("a.AT2", "b[1].AT2"):
        (folder / name).touch()
    (folder / "site.toml").write_text('[records]\npaths = ["*.AT2", "b[1].AT2"]')
    pattern, file = load_config(folder / "site.toml").record_paths()
    assert sorted(Path(hit).name for hit in glob.glob(str(pattern))) == ["a.AT2", "b[1].AT2"]  # noqa: PTH207
    assert file == folder / "b[1].AT2"


_numbers = st.floats(min_value=1e-6, max_value=1e6)
_texts = st.text(st.characters(codec="utf-8"), max_size=12)
_names = _texts.filter(lambda name: name.strip() and "/" not in name and name.isprintable())
_ratios = st.floats(0.0, 1.0)
_restitutions = st.one_of(st.just("housner"), _ratios, st.lists(_ratios, min_size=2, max_size=2).map(tuple))


@st.composite
def _configs(draw):
    sections = {}
    for name, section in SECTIONS.items():
        values = {}
        for field in dataclasses.fields(section):
            takes = field.metadata["values"]
            pools = [st.just(field.default)]
            if takes.words and isinstance(field.default, str):
                pools.append(st.sampled_from(takes.words))
            elif isinstance(field.default, str):
                pools.append(_texts)
            elif isinstance(field.default, float):
                # What is out of range becomes the default: filters would throw most draws away.
                numbers = st.one_of(st.floats(0.5, 0.99), _numbers)
                pools.append(
                    numbers.map(lambda value, takes=takes, own=field.default: value if takes.accepts(value) else own)
                )
            values[field.name] = draw(st.one_of(pools))
        if values.get("method") == "window":
            values.update(start_s=1.0, end_s=draw(st.floats(1.5, 1e3)))
        if name == "records":
            rotated = values["components"] == "azimuth"
            values.update(azimuth=draw(st.floats(1e-6, 360.0)) if rotated else None)
            values.update(azimuth_step=180.0 / draw(st.integers(2, 180)))
        if name == "calibration":
            values.update(target=None if values["scale_to"] == "none" else draw(_numbers))
            values.update(weights=draw(st.sampled_from(["equal", "event", "weights.csv"])))
        if name == "check" and values["spectrum"] != "ntc":
            values.update(topography="T1")
        if name == "check" and values["spectrum"] == "table":
            values.update(file="spectrum.csv")
        sections[name] = section(**values)
    names = draw(st.lists(_names, unique=True, max_size=3))
    blocks = [
        BlockSettings(
            name=name, width=draw(_numbers), height=draw(_numbers), restitution=draw(_restitutions), confirm_size=True
        )
        for name in names
    ]
    return Config(**sections, bodies=tuple(blocks))


@pytest.mark.sweep
@settings(derandomize=True, deadline=None, max_examples=10)
@given(config=_configs())
def test_the_text_of_a_configuration_loads_back_to_it(tmp_path_factory, config):
    path = tmp_path_factory.mktemp("config") / "resolved.toml"
    path.write_text(config.as_text(), encoding="utf-8", newline="")
    assert load_config(path) == config


def test_odd_characters_survive_the_way_through_toml(tmp_path):
    config = Config(bodies=(BlockSettings(name='"\\ è 柱', p=1.0, alpha=math.pi / 8),))
    path = tmp_path / "odd.toml"
    path.write_text(config.as_text(), encoding="utf-8")
    assert load_config(path) == config


def test_a_size_that_was_confirmed_and_a_radius_load_back(load):
    text = "[[block]]\nname = 'hall'\nwidth = 40\nheight = 160\n"
    with pytest.raises(
        ConfigError, match=r'site.toml: \[\[block\]\] "hall": 40 x 160: are these centimetres\? .*confirm_size = true'
    ):
        load(text)
    config = load(text + "confirm_size = true\n[[block]]\nname = 'statue'\np = 2.385\nalpha = 0.2445\nradius = 1.136\n")
    assert load(config.as_text()) == config
    assert [block.confirm_size for block in config.bodies] == [True, False]
    assert [block.radius for block in config.bodies] == [None, 1.136]


def test_demands_are_read_and_written(load):
    text = '[[demand]]\nname = "ULS"\nvalue = "0.25 g"\n'
    text += '[[demand]]\nvalue = 1\nlimit_state = "50 years"\n'
    text += '[[demand]]\nname = "SLC"\nmeasure = "sa"\nvalue = 5\nperiod = 1.0\n'
    config = load(text)
    assert [demand.name for demand in config.demands] == ["ULS", "PGA 1 m/s2", "SLC"]
    assert [demand.strength for demand in config.demands] == [0.25 * STANDARD_GRAVITY, 1.0, 5.0]
    assert [demand.measure for demand in config.demands] == ["pga", "pga", "sa"]
    assert config.demands[1].limit_state == "50 years"
    assert load(config.as_text()) == config


@pytest.mark.parametrize(
    ("option", "name", "strength"),
    [
        ("pga=0.35g", "PGA 0.35 g", 0.35 * STANDARD_GRAVITY),
        ("PGV = 40 cm/s", "PGV 40 cm/s", 0.4),
        ("sa(1.0)=4m/s2", "Sa(1 s) 4 m/s2", 4.0),
        ("velocity_ratio=0.8", "p PGV/(g tan alpha_c) 0.8", 0.8),
    ],
)
def test_a_demand_on_the_command_line(option, name, strength):
    found = parse_demand_option(option)
    assert (found.name, found.strength) == (name, pytest.approx(strength))


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ("0.35g", r'expected MEASURE=VALUE with a unit, such as "pga=0.35g"'),
        ("pga=0.35", r'"pga=0.35": \[\[demand\]\] value: expected a positive number and its unit \(m/s2, g'),
        ("pga=-1g", "expected a positive number"),
        ("sa=1g", r"needs the period"),
        ("pgd=1m", 'did you mean "pgv"'),
    ],
)
def test_a_wrong_demand_on_the_command_line(option, told):
    with pytest.raises(ConfigError, match=told):
        parse_demand_option(option)


def test_the_ground_of_a_site_is_given_once(load):
    text = '[site]\nag = 0.25\nground = "B"\n[check]\nf0 = 2.4\ntc_star = 0.35\n'
    config = load(text)
    soil = 1.4 - 0.4 * 2.4 * 0.25
    (demand,) = config.demands
    assert (demand.name, demand.measure) == ("a_g S", "pga")
    assert demand.strength == pytest.approx(0.25 * soil * STANDARD_GRAVITY)
    assert (config.check.ag, config.check.ground, config.hazard.soil) == (0.25, "B", pytest.approx(soil))
    assert load(config.as_text()) == config
    own = load(text + "[hazard]\nsoil_factor = 1.0\n[[demand]]\nvalue = 2.0\nlimit_state = 'SLC'\n")
    assert (own.hazard.soil, own.demands[0].strength) == (1.0, 2.0)
    assert load(text + "[[demand]]\nvalue = '0.29 g'\n").demands[0].name == "PGA 0.29 g"  # a_g S, rounded
    with pytest.raises(ConfigError, match=r"expected the PGA of \[site\], 0\.29 g \(a_g S\), found 0\.35 g"):
        load(text + "[[demand]]\nvalue = '0.35 g'\n")
    assert load('[site]\nag = 0.25\n[check]\nspectrum = "en_1998_1"\nground = "C"\n').check.ground == "C"
    assert load('[site]\nag = 0.25\nground = "C"\n[check]\nspectrum = "en_1998_1"\n').hazard.soil == 1.15
    assert load("[site]\nag = 0.25\n").hazard.soil == 1.0
    with pytest.raises(
        ConfigError, match=r"S of ground B by NTC 2018 depends on F_0; give f0 and tc_star in \[check\]"
    ):
        load('[site]\nag = 0.25\nground = "B"\n')
    with pytest.raises(ConfigError, match=r'\[site\] ag: S of ground B is not known with \[check\] spectrum = "table"'):
        load('[site]\nag = 0.25\nground = "B"\n[check]\nspectrum = "table"\nfile = "s.csv"\n')


def test_a_site_may_state_its_pga(load):
    config = load('[site]\npga = "0.35 g"\n')
    assert [(one.name, one.strength) for one in config.demands] == [("PGA 0.35 g", 0.35 * STANDARD_GRAVITY)]
    assert load(config.as_text()) == config
    with pytest.raises(ConfigError, match=r'expected pga or ag .* found both, "0\.35 g" and 0\.2 g'):
        load('[site]\npga = "0.35 g"\nag = 0.2\n')
    with pytest.raises(ConfigError, match=r"\[site\] pga: expected a positive number and its unit"):
        load('[site]\npga = "0.35"\n')


def test_without_loads_the_crushed_depth_needs_no_length(load):
    wall = '[[block]]\nname = "wall"\nwidth = 0.6\nheight = 6.0\ndensity = 1800.0\ncompressive_strength = 2e6\n'
    (one,), (long,) = load(wall).bodies, load(wall + "length = 5.0\n").bodies
    assert one.block().alpha_c == pytest.approx(long.block().alpha_c, rel=1e-12)
    with pytest.raises(ConfigError, match="and length, if there are ties, loads or thrusts"):
        load(wall + "[[block.load]]\nweight = 1e4\nheight = 5.0\n")


def test_units_and_intervals_of_some_files_are_read_and_written(load):
    text = '[records]\nunits = "cm/s2"\nconfirm = ["CI.CCC*"]\n'
    text += '[[records.file]]\nmatch = "*.g3"\nunits = "g"\ndt = 0.02\n[[records.file]]\nmatch = "old/*"\ndt = 1\n'
    config = load(text + "[run]\nseed = 3\n")
    first, second = config.records.files
    assert (first.match, first.units, first.dt) == ("*.g3", "g", 0.02)
    assert (second.match, second.units, second.dt) == ("old/*", None, 1.0)
    assert (config.records.confirm, config.run.seed) == (("CI.CCC*",), 3)
    assert load(config.as_text()) == config


def test_files_are_sections_in_python_too():
    with pytest.raises(ConfigError, match=r"\[records\] files: expected a list of FileSettings, in TOML \[\[rec"):
        rp.RecordSettings(files=({"match": "*"},))


def test_the_uncertainty_is_read_and_written_and_is_that_of_the_solver(load):
    text = '[records]\ncomponents = "sweep"\n[uncertainty]\nfactor = 0.2\nrestitution = [0.8, 1]\nazimuth = true\n'
    config = load(text + "[search]\nintervals = true\n")
    assert load(config.as_text()) == config
    assert config.search.intervals
    assert config.uncertainty.of_draws() == rp.models.Uncertainty(factor=0.2, restitution=(0.8, 1.0), geometry=0.05)
    assert rp.UncertaintySettings().of_draws() == rp.models.Uncertainty()
    for key, (low, high) in {"factor": (0.02, 1.0), "geometry": (0.0, 1.0)}.items():
        assert [getattr(rp.UncertaintySettings(**{key: end}).of_draws(), key) for end in (low, high)] == [low, high]


@pytest.mark.parametrize(
    ("text", "shares"),
    [
        ("[0.97, 1.2, 0.97, 0.9]", (0.9, 0.97, 0.97, 1.2)),  # measured values
        ("[2.0, 2]", (2.0, 2.0)),
    ],
)
def test_a_restitution_is_a_range_or_measured_values_over_the_nominal_one(load, text, shares):
    config = load(f"[uncertainty]\nrestitution = {text}\n")
    assert config.uncertainty.of_draws().restitution == shares
    assert load(config.as_text()) == config


@pytest.mark.parametrize(("mean", "deviation"), [(0.98, 0.03), (1.4, 0.19), (0.31, 0.1)])
def test_a_restitution_of_mean_and_deviation_is_a_normal_distribution(load, mean, deviation):
    """By its moments and its quartiles, at 20,000 ranks."""
    config = load(f"[uncertainty]\nrestitution = {{mean = {mean}, deviation = {deviation}}}\n")
    drawn = config.uncertainty.of_draws().restitutions(0.3, (np.arange(20_000) + 0.5) / 20_000) / 0.3
    assert np.mean(drawn) == pytest.approx(mean, rel=1e-6)
    assert np.std(drawn) == pytest.approx(deviation, rel=0.003)
    quartiles = mean + deviation * np.array([-0.67449, 0.0, 0.67449])
    assert np.quantile(drawn, [0.25, 0.5, 0.75]) == pytest.approx(quartiles, abs=0.001 * deviation)
    assert load(config.as_text()) == config
