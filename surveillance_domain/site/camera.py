"""A pan/tilt/zoom camera as the site file describes it: ``[[cameras]]`` and its presets."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from surveillance_domain.site.fields import (
    Count,
    Degrees,
    EnvironmentName,
    FileName,
    Flag,
    Length,
    Name,
    Noise,
    Number,
    Position,
    Positive,
    Probability,
    Seconds,
    Section,
    Url,
    UserName,
)

__all__ = ["Camera", "Image", "Mount", "Preset", "PrivacyMask"]

_Pixels = Annotated[Count, Field(ge=1, le=65536)]
_FieldOfView = Annotated[Number, Field(gt=0, lt=180)]
_Row = tuple[Number, Number, Number]


class Mount(Section):
    """Where a camera hangs and how its own frame lies in the room.

    The mount's frame is forward, left, up. It is turned by ``yaw_deg`` counter-clockwise from +x, then raised by
    ``pitch_deg`` (positive: forward goes up), then rolled about its forward axis by ``roll_deg`` (positive: left
    goes up). ``inverted`` turns it by another 180 degrees about the forward axis.
    """

    position_m: Position = Field(description="[x, y, height] in metres, height 0 or more")
    yaw_deg: Degrees = Field(0.0, description="degrees counter-clockwise from +x, -360 to 360")
    pitch_deg: Degrees = Field(0.0, description="degrees, positive up, -360 to 360")
    roll_deg: Degrees = Field(0.0, description="degrees about the forward axis, -360 to 360")
    pan_clockwise: Flag = Field(True, description="true or false (true: positive pan turns clockwise)")
    inverted: Flag = Field(False, description="true or false (true: hangs and reports upside down)")


class Image(Section):
    """Size of a camera's picture in pixels."""

    width: _Pixels = Field(description="a whole number of pixels, 1 to 65536")
    height: _Pixels = Field(description="a whole number of pixels, 1 to 65536")


class PrivacyMask(Section):
    """A rectangle that a privacy mask set in the camera itself covers, in the camera's own numbers."""

    pan_deg: tuple[Degrees, Degrees] = Field(
        description="[from, to], degrees as the camera shows them, rising by at most 180; [170, -170] goes over 180"
    )
    tilt_deg: tuple[Degrees, Degrees] = Field(
        description="[from, to], degrees as the camera shows them, the lower one first"
    )


class Preset(Section):
    """One value of a camera's state variable: a position in the camera's own numbers."""

    name: Name = Field(description="a name of 1 to 64 printable characters")
    pan: Degrees = Field(description="degrees as the camera shows them, -360 to 360")
    tilt: Degrees = Field(description="degrees, positive up, -360 to 360")
    zoom: Positive = Field(description="a zoom position above 0, within zoom_hfov")
    homography: tuple[_Row, _Row, _Row] | None = Field(
        None, description="three rows of three finite numbers (image to floor), not singular"
    )


class Camera(Section):
    """A pan/tilt/zoom camera."""

    name: Name = Field(description="a name of 1 to 64 printable characters")
    mount: Mount = Field(description="a table with position_m = [x, y, height]")
    presets: Annotated[tuple[Preset, ...], Field(min_length=1)] = Field(
        description="at least one [[cameras.presets]] table with name, pan, tilt and zoom"
    )
    privacy_masks: tuple[PrivacyMask, ...] = Field(
        (), description="tables such as { pan_deg = [-20, 10], tilt_deg = [-60, -40] }, as set in the camera"
    )
    home: Name | None = Field(None, description="the name of one of the camera's presets")
    zoom_hfov: Annotated[tuple[tuple[Positive, _FieldOfView], ...], Field(min_length=1)] = Field(
        description="pairs [zoom, horizontal field of view in degrees between 0 and 180], "
        "zoom rising, field of view falling"
    )
    image: Image = Field(description="a table such as { width = 704, height = 576 }")
    required_px_per_m: Positive | None = Field(
        None, description="pixels per metre above 0 (EN 62676-4: detect 25, observe 62.5, recognise 125, identify 250)"
    )
    max_depth_m: Length | None = Field(None, description="metres above 0")
    detection_probability: Probability = Field(1.0, description="a probability, 0 to 1")
    cell_noise_m: Noise = Field(0.0, description="metres, 0 or more")
    pan_deg_per_s: Positive | None = Field(None, description="degrees per second above 0")
    tilt_deg_per_s: Positive | None = Field(None, description="degrees per second above 0")
    zoom_per_s: Positive | None = Field(None, description="zoom positions per second above 0")
    settle_s: Annotated[Number, Field(ge=0, le=3600)] = Field(0.0, description="seconds, 0 to 3600")
    tolerance_deg: Annotated[Number, Field(gt=0, le=90)] = Field(0.2, description="degrees above 0, at most 90")
    move_deadline_s: Seconds = Field(8.0, description="seconds above 0")
    connect_timeout_s: Seconds = Field(2.0, description="seconds above 0")
    read_timeout_s: Seconds = Field(5.0, description="seconds above 0")
    driver: Literal["vapix"] = Field("vapix", description='"vapix"')
    url: Url | None = Field(None, description="an address such as http://192.168.0.90")
    channel: Annotated[Count, Field(ge=1, le=1024)] = Field(1, description="a whole number from 1")
    auth: Literal["auto", "digest", "basic"] = Field("auto", description='"auto", "digest" or "basic"')
    username: UserName | None = Field(None, description="a user name without colon or space, at most 64 characters")
    password_env: EnvironmentName | None = Field(
        None, description="the name of an environment variable that holds the password"
    )
    ca_file: FileName | None = Field(None, description="the path of a certificate file, for https only")
