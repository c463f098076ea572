"""Author, client, project and logo in the head of the page, code checks and data of bodies: from the configuration."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest
from results_tree import BLOCKS, results_tree

import rockpulse as rp
from rockpulse import ModelSettings, ReportSettings, SearchSettings
from rockpulse.cli import main
from rockpulse.config.study_settings import LOGO_LIMIT, PNG
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.storage.hdf5.results_file import load_tree
from rockpulse.views.report.content import code_checks, logo, page_content, parties
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared.words import writing

#: A picture of one pixel.
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


@pytest.fixture
def given(tmp_path, config):
    """A configuration with all of [report], its logo beside it."""
    (tmp_path / "logo.png").write_bytes(PIXEL)
    report = ReportSettings(author="A. Rossi", client="Comune di <Vasto>", project="Torre", logo="logo.png")
    return replace(config, report=report, folder=tmp_path)


@pytest.mark.slow
def test_they_are_stored_in_the_results_and_a_configuration_takes_their_place(given, bursts, bodies, tmp_path):
    page = report_page(results_tree(), config=given)
    for words in ("A. Rossi", "Comune di &lt;Vasto&gt;", "Torre", base64.b64encode(PIXEL).decode()):
        assert words in page
    given = replace(given, models=ModelSettings(use=("linear",)), search=SearchSettings(models=()))
    rp.save(rp.assess(bursts[:1], given, {"stele": bodies["stele"]}), tmp_path / "results.h5")
    (tmp_path / "logo.png").unlink()
    tree = load_tree(tmp_path / "results.h5")
    assert [fact.lines for fact in parties(tree)] == [("Torre",), ("Comune di <Vasto>",), ("A. Rossi",)]
    assert logo(tree) == base64.b64encode(PIXEL).decode()
    tree.attrs["report_logo"] = base64.b64encode(b"GIF89a").decode()
    with pytest.raises(ResultsError, match="report_logo: expected a PNG"):
        logo(tree)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cannot be read"),
        (b"GIF89a", "expected a PNG picture"),
        (PNG + bytes(LOGO_LIMIT), "at most 45,000 bytes"),
    ],
)
def test_a_logo_that_is_no_small_png_is_told_before_any_work(content, message, tmp_path, capsys):
    if content is not None:
        (tmp_path / "logo.png").write_bytes(content)
    path = tmp_path / "site.toml"
    path.write_text('[report]\nlogo = "logo.png"\n')
    with pytest.raises(ConfigError, match=message):
        rp.load_config(path)
    assert main(["report", str(tmp_path / "none.h5"), "-o", str(tmp_path / "r.html"), "--config", str(path)]) == 2
    assert message in capsys.readouterr().err


def checked_tree(check='spectrum = "ntc"\nag = 0.2\nf0 = 2.4\ntc_star = 0.3'):
    """Results whose configuration has a code check and the sizes of their bodies; the second has a tie."""
    tree = results_tree()
    sizes = "".join(f'[[block]]\nname = "{name}"\nwidth = 0.6\nheight = 3.0\n' for name in BLOCKS)
    tree.attrs["configuration"] = f"[check]\n{check}\n{sizes}density = 1800.0\nlength = 4.0\n"
    tie = {"height": 2.5, "stiffness": 6e6, "gap": 0.0, "yield_force": 3e4, "ultimate": np.inf, "side": "both"}
    held = np.array(["", json.dumps({"ties": [tie], "loads": [], "thrusts": []}), ""], dtype=object)
    floors = np.array(["", "", json.dumps([{"period": 0.4, "damping": 0.05, "participation": 1.2}])], dtype=object)
    known = tree["summary"].to_dataset().assign(restraints=("block", held), floors=("block", floors))
    tree["summary"] = known
    return tree


def test_code_checks_of_the_configuration_are_on_the_page_in_the_order_of_the_verdicts():
    tree = checked_tree()
    with writing("it"):
        content = page_content(tree, checked=code_checks(tree))
    (table,) = content.check.tables
    assert "a_g = 0,2 g, categoria di sottosuolo A" in table.caption
    assert list(dict.fromkeys(row[0].text for row in table.rows)) == [card.name for card in content.cards]
    assert [body.name for body in content.bodies] == [card.name for card in content.cards]
    row = table.rows[0]
    assert (row[1].text, row[2].text) == ("Circolare 617/2009", "0,2")
    assert {row[6].text for row in table.rows} == {"sì", "no"}
    config = rp.Config(check=rp.CheckSettings(spectrum="en_1998_1", ag=0.01))
    assert float(code_checks(tree, config)["activation_ratio"].min()) > 1.0


def test_without_a_spectrum_there_are_no_code_checks_and_a_missing_table_is_named():
    assert code_checks(results_tree()) is None
    with pytest.raises(ConfigError, match="no body to check"):
        code_checks(results_tree(), code="circolare_2009")
    tree = checked_tree('spectrum = "table"\nfile = "nowhere.csv"')
    found = page_content(tree, checked=code_checks(tree)).check
    assert "the table nowhere.csv of the spectrum was not found" in found.warnings[0]


def test_ties_floors_and_density_are_among_the_facts_of_a_body():
    with writing("it"):
        bodies = {one.name: one.facts for one in page_content(checked_tree()).bodies}
    facts = [{fact.name: fact.lines for fact in bodies[name]} for name in BLOCKS]
    tie = "altezza 2,5 m, rigidezza 6000 kN/m, forza di snervamento 30 kN, entrambi i lati"
    assert (facts[1]["catene"], "catene" in facts[0]) == ((tie,), False)
    modes = "T = 0,4 s, smorzamento 0,05, coefficiente di partecipazione 1,2"
    assert facts[2]["modi di vibrare del solaio"] == (modes,)
    assert facts[2]["densità"] == ("1800 kg/m³, lunghezza 4 m",)


def test_the_configuration_and_hashes_are_on_a_full_page_only():
    tree = results_tree()
    brief, full = page_content(tree), page_content(tree, full=True)
    assert (brief.configuration, full.configuration) == ("", tree.attrs["configuration"])
    named = [[fact.name for fact in content.records[0].facts] for content in (brief, full)]
    assert ["SHA-256 of the source" in names for names in named] == [False, True]
