"""The site file as a whole, ``schema_version = 1``."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.fields import Count, Section
from surveillance_domain.site.sections import Control, Map, Markers, Operation, PrivateArea, StaticCamera, Targets

__all__ = ["SiteFile"]


class SiteFile(Section):
    """Every table of a site file, ``[defaults]`` already merged into the cameras."""

    schema_version: Annotated[Count, Field(ge=1, le=1)] = Field(description="1")
    map: Map = Field(description="a [map] table with cell_m and either rows or ros")
    cameras: Annotated[tuple[Camera, ...], Field(min_length=1)] = Field(
        description="at least one [[cameras]] table with name, mount, zoom_hfov, image and presets"
    )
    targets: Targets = Field(default_factory=Targets, description="a [targets] table")
    control: Control = Field(default_factory=Control, description="a [control] table")
    static_cameras: tuple[StaticCamera, ...] = Field((), description="[[static_cameras]] tables")
    operation: Operation = Field(default_factory=Operation, description="an [operation] table")
    privacy: tuple[PrivateArea, ...] = Field((), description="[[privacy]] tables with polygon_m")
    markers: Markers | None = Field(None, description="a [markers] table with side_m")
