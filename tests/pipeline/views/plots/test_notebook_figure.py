"""A picture is shown by a notebook that has never heard of pyplot."""

import io

import pytest
from PIL import Image

import rockpulse as rp
from rockpulse.views.plots.style import figure_of


def test_a_notebook_is_given_the_picture_and_its_width():
    data, told = rp.plot(rp.models.Block(width=0.25, height=2.2))._repr_png_()
    assert Image.open(io.BytesIO(data)).width == 1260  # 200 dots per inch
    assert told == {"width": 630}


@pytest.mark.parametrize("width", [2.0, 6.3])
def test_the_width_is_that_of_the_figure(width):
    figure = figure_of(width=width, height=1.0)
    assert figure._repr_png_()[1]["width"] == round(100.0 * width)
