"""What the file of a record states about its earthquake and its site, stored for every record in every study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from rockpulse.storage.variables import Declared, along, real, text

__all__ = ["FACTS", "facts_of"]

_STATED: Declared = {
    "event_id": text("identifier of the earthquake at the agency"),
    "origin_time": text("UTC time of the earthquake, ISO 8601"),
    "magnitude": real("1", "magnitude of the earthquake"),
    "magnitude_type": text("scale of the magnitude as the file has it: Mw, ML"),
    "hypocentre_latitude": real("degrees_north", "latitude of the hypocentre"),
    "hypocentre_longitude": real("degrees_east", "longitude of the hypocentre"),
    "hypocentre_depth": real("m", "depth of the hypocentre"),
    "epicentral_distance": real("m", "distance of the station from the epicentre, as the file states it"),
    "station_latitude": real("degrees_north", "latitude of the station"),
    "station_longitude": real("degrees_east", "longitude of the station"),
    "vs30": real("m s-1", "time-averaged velocity of shear waves in the upper 30 m"),
    "site_class": text("class of the ground as the file words it"),
    "sensor_depth": real("m", "depth of the sensor below the ground, as the file states it"),
}


def _stated(name: str) -> Callable[[Any], Any]:
    return lambda one: getattr(one.record, name)


def _origin_time(one: Any) -> str:
    return "" if one.record.origin_time is None else one.record.origin_time.isoformat()


#: By the names of the fields of a record, taken from whatever has a `record`.
FACTS: Declared = {
    name: replace(variable, since=2, take=_origin_time if name == "origin_time" else _stated(name))
    for name, variable in along(("record",), _STATED).items()
}


def facts_of(one: Any) -> dict[str, Any]:
    """The values of :data:`FACTS` of whatever has a `record`."""
    return {name: fact.take(one) for name, fact in FACTS.items() if fact.take is not None}
