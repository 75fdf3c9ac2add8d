"""From the tables of a site file to the schema, ``[defaults]`` merged into the cameras."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from surveillance_domain.site.explain import Location, faults_of, shown
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.schema import SiteFile

__all__ = ["validate"]


def validate(tables: Mapping[str, Any]) -> tuple[SiteFile | None, tuple[Fault, ...]]:
    """The site file that the tables describe, or ``None`` and every fault of its fields.

    ``[defaults]`` is merged into each camera key by key: a camera's own ``mount`` replaces the whole default mount.
    A fault of a default is reported once, under ``defaults``.
    """
    defaults = tables.get("defaults", {})
    if not isinstance(defaults, dict):
        return None, (Fault("defaults", shown(defaults), "a [defaults] table of camera keys"),)
    merged = {key: value for key, value in tables.items() if key != "defaults"}
    cameras = merged.get("cameras")
    if isinstance(cameras, list):
        merged["cameras"] = [{**defaults, **one} if isinstance(one, dict) else one for one in cameras]

    def as_written(location: Location) -> Location:
        match location:
            case ("cameras", int(index), key, *rest) if key in defaults and key not in tables["cameras"][index]:
                return ("defaults", key, *rest)
        return location

    try:
        return SiteFile.model_validate(merged), ()
    except ValidationError as error:
        return None, faults_of(error, SiteFile, merged, as_written)
