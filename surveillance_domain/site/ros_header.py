"""The yaml file of a ROS map_server map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from surveillance_domain.site.explain import faults_of
from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.fields import FileName, Metres, Number, Probability

__all__ = ["RosHeader", "RosMapError", "read_ros_header"]

_MOST_BYTES = 1_000_000


class RosMapError(SiteError):
    """A map_server pair that cannot be used."""


class RosHeader(BaseModel):
    """The keys that map_server reads; others are left alone, as map_server does."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    image: FileName = Field(description="the path of a PGM, PNG or BMP picture")
    resolution: Annotated[Number, Field(gt=0, le=1000)] = Field(description="metres per pixel above 0")
    origin: tuple[Metres, Metres, Number] = Field(description="[x, y, yaw] in metres and radians")
    negate: Literal[0, 1, False, True] = Field(0, description="0 or 1")
    occupied_thresh: Probability = Field(description="a number from 0 to 1")
    free_thresh: Probability = Field(description="a number from 0 to 1")
    mode: Literal["trinary", "scale", "raw"] = Field("trinary", description='"trinary", "scale" or "raw"')


def read_ros_header(path: Path) -> tuple[RosHeader, bytes]:
    """The yaml file's keys and its bytes.

    Raises
    ------
    RosMapError
        With every fault of the file.
    """
    content = _content(path)
    header = _header(path, _tables(path, content))
    faults = []
    if header.origin[2] != 0:
        faults.append(Fault("origin", f"a yaw of {header.origin[2]:g}", "a yaw of 0: turn the picture itself instead"))
    if header.free_thresh > header.occupied_thresh:
        found = f"{header.free_thresh:g}, above occupied_thresh = {header.occupied_thresh:g}"
        faults.append(Fault("free_thresh", found, "at most occupied_thresh"))
    if faults:
        raise RosMapError(str(path), tuple(faults))
    return header, content


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise RosMapError(str(path), (Fault("", f"{path.stat().st_size} bytes", "at most a million"),))
        return path.read_bytes()
    except OSError as error:
        found = "no such file" if isinstance(error, FileNotFoundError) else (error.strerror or "no access").lower()
        raise RosMapError(str(path), (Fault("", found, "a ROS map_server yaml file"),)) from None


def _tables(path: Path, content: bytes) -> dict[str, Any]:
    import yaml

    try:
        tables = yaml.safe_load(content)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}" if mark is not None else ""
        raise RosMapError(str(path), (Fault(where, "text that is not YAML", "a ROS map_server yaml file"),)) from None
    if not isinstance(tables, dict):
        raise RosMapError(str(path), (Fault("", "no keys", "image, resolution, origin and thresholds"),))
    return tables


def _header(path: Path, tables: dict[str, Any]) -> RosHeader:
    try:
        return RosHeader.model_validate(tables)
    except ValidationError as error:
        raise RosMapError(str(path), faults_of(error, RosHeader, tables)) from None
