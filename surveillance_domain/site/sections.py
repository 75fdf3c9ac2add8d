"""The other tables of a site file: map, targets, control, static cameras, operation, privacy, markers."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from surveillance_domain.site.fields import (
    Count,
    FileName,
    Height,
    Length,
    Name,
    Noise,
    Number,
    Point,
    Position,
    Rate,
    Seconds,
    Section,
)

__all__ = [
    "Control",
    "Door",
    "KnownTarget",
    "Map",
    "Markers",
    "Operation",
    "PrivateArea",
    "StaticCamera",
    "Targets",
]

_Index = Annotated[Count, Field(ge=0)]
_Speed = Annotated[Number, Field(ge=0, le=1000)]


class Map(Section):
    """Where people can walk: rows drawn in the file, or a ROS map_server file."""

    ros: FileName | None = Field(None, description="the path of a ROS map_server yaml file")
    rows: Annotated[tuple[str, ...], Field(min_length=1)] | None = Field(
        None, description="rows of equal length, top row first, '#' blocked and '.' free"
    )
    cell_m: Annotated[Length, Field(ge=1e-3)] = Field(description="the side of a cell in metres, 0.001 or more")
    unknown: Literal["blocked", "free"] = Field("blocked", description='"blocked" or "free"')


class KnownTarget(Section):
    """A target whose identity the pictures give."""

    name: Name = Field(description="a name of 1 to 64 printable characters")
    marker: _Index | None = Field(None, description="the number of a marker, 0 or more")
    color: Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")] | None = Field(
        None, description='a colour such as "#ff8000": red, green, blue'
    )


class Door(Section):
    """Cells through which targets come and go."""

    cells: Annotated[tuple[tuple[_Index, _Index], ...], Field(min_length=1)] = Field(
        description="at least one free cell [column, row], counted from the lower left"
    )
    rate_per_s: Rate = Field(description="entries per second, 0 to 1000")


class Targets(Section):
    """How targets move, and which are known by name."""

    directions: Annotated[Count, Field(ge=1, le=360)] = Field(8, description="a whole number of directions, 1 to 360")
    speeds_mps: Annotated[tuple[_Speed, ...], Field(min_length=1)] = Field(
        (1.0,), description="at least one speed in metres per second, 0 to 1000, each greater than the one before"
    )
    sigma_direction_deg: Annotated[Number, Field(ge=0, le=360)] = Field(30.0, description="degrees, 0 to 360")
    sigma_speed_mps: Annotated[Number, Field(ge=0, le=1000)] = Field(0.2, description="metres per second, 0 to 1000")
    walls: Literal["reject", "reflect", "stay"] = Field("reject", description='"reject", "reflect" or "stay"')
    prior: FileName = Field("uniform", description='"uniform", or the path of a CSV file: column,row,weight')
    known: tuple[KnownTarget, ...] = Field((), description='tables such as { name = "red", marker = 7 }')
    doors: tuple[Door, ...] = Field((), description="[[targets.doors]] tables with cells and rate_per_s")


class Control(Section):
    """The pace of the control loop and who decides."""

    step_s: Annotated[Number, Field(gt=0, le=3600)] = Field(1.0, description="seconds above 0, at most 3600")
    controller: Literal["pomdp", "mp", "msp", "sys", "stat", "full-information", "clairvoyant"] = Field(
        "pomdp", description='"pomdp", "mp", "msp", "sys", "stat", "full-information" or "clairvoyant"'
    )
    deadline_s: Seconds = Field(0.1, description="seconds above 0")


class StaticCamera(Section):
    """A static wide-view camera; only the controller MSP uses it."""

    name: Name = Field(description="a name of 1 to 64 printable characters")
    position_m: Position = Field(description="[x, y, height] in metres, height 0 or more")
    noise_m: tuple[Noise, Noise] = Field(
        description="[sigma_0, kappa], both 0 or more: sigma = sigma_0 + kappa * distance, in metres"
    )


class Operation(Section):
    """A guard's night."""

    yield_s: Annotated[Number, Field(ge=0, le=1e6)] = Field(60.0, description="seconds, 0 or more")
    forget_s: Seconds = Field(120.0, description="seconds above 0")
    keep_days: Annotated[Number, Field(ge=0, le=36525)] = Field(7.0, description="days, 0 to 36525")
    alert_command: Annotated[str, Field(min_length=1)] | None = Field(None, description="a command, not empty")


class PrivateArea(Section):
    """A part of the floor that no preset may look into."""

    polygon_m: Annotated[tuple[Point, ...], Field(min_length=3)] = Field(
        description="at least three points [x, y] in metres that enclose an area"
    )


class Markers(Section):
    """The fiducial markers that targets carry."""

    dictionary: Annotated[str, Field(pattern=r"^([4-7]X[4-7]_(50|100|250|1000)|ARUCO_ORIGINAL)$")] = Field(
        "4X4_50", description='an ArUco dictionary such as "4X4_50" or "6X6_250"'
    )
    side_m: Annotated[Length, Field(le=100)] = Field(description="metres above 0, at most 100")
    height_m: Height = Field(0.0, description="metres above the floor, 0 or more")
