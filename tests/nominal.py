"""Configurations of the nominal bodies: every model, the sequence by statistics, all factors, no probability."""

from dataclasses import replace
from pathlib import Path

import rockpulse as rp
from rockpulse.assessment.scene import extract
from rockpulse.model_table import ALL_MODELS, DEFAULT_MODELS
from rockpulse.selection.directions import conditioned

#: The same for the command line.
FILE = Path(__file__).with_name("nominal.toml")


def Config(**sections):
    search = replace(sections.pop("search", rp.SearchSettings()), intervals=True)
    models, sequence = sections.pop("models", rp.ModelSettings()), sections.pop("sequence", rp.SequenceSettings())
    if models.use == DEFAULT_MODELS:
        models = replace(models, use=ALL_MODELS)
    sequence = replace(sequence, method="statistics")
    uncertainty = {"uncertainty": rp.UncertaintySettings(probability=False)}
    return rp.Config(**uncertainty | sections, search=search, models=models, sequence=sequence)


def scene_of_record(record, config, vertical=None):
    """The input of the models, from a record and its vertical channel as they were read."""
    return extract(conditioned(record, config), config, vertical and conditioned(vertical, config))


def ida(**fragility):
    """Section [fragility] for an incremental analysis of every record, however far it is scaled."""
    return rp.FragilitySettings(**{"data": "ida", "factors": (0.01, 100.0), "pga_min": 0.0} | fragility)
