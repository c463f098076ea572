"""Author, client, project and logo in the head of the page: of the results, or of the configuration in their place."""

import base64
from dataclasses import replace

import pytest
from results_tree import results_tree

import rockpulse as rp
from rockpulse import ModelSettings, ReportSettings, SearchSettings
from rockpulse.cli import main
from rockpulse.config.study_settings import LOGO_LIMIT, PNG
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.storage.hdf5.results_file import load_tree
from rockpulse.views.report.content import logo, parties
from rockpulse.views.report.writing import report_page

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
