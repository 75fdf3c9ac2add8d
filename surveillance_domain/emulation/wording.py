"""The words of an AXIS camera's answers, as in published recordings of them."""

from __future__ import annotations

from surveillance_domain.cameras.base import Limits
from surveillance_domain.emulation.kinematics import Axes

__all__ = ["CHANNEL_MISSING", "attributes_text", "error_text", "limits_text", "parameters_text", "position_text"]

CHANNEL_MISSING = "<!--Camera {channel} not available.-->\n"

_PARAMETERS = {
    "root.PTZ.NbrOfSerPorts": "0",
    "root.PTZ.CamPorts.Cam1Port": "1",
    "root.PTZ.ImageSource.I0.PTZEnabled": "true",
    "root.PTZ.Limit.L1.MinPan": "{pan[0]:g}",
    "root.PTZ.Limit.L1.MaxPan": "{pan[1]:g}",
    "root.PTZ.Limit.L1.MinTilt": "{tilt[0]:g}",
    "root.PTZ.Limit.L1.MaxTilt": "{tilt[1]:g}",
    "root.PTZ.Limit.L1.MinZoom": "{zoom[0]:g}",
    "root.PTZ.Limit.L1.MaxZoom": "{zoom[1]:g}",
    "root.PTZ.Various.V1.CtlQueueing": "false",
    "root.PTZ.Various.V1.ReturnToOverview": "0",
    "root.Image.NbrOfConfigs": "1",
    "root.Brand.Brand": "AXIS",
    "root.Brand.ProdFullName": "AXIS 214 PTZ Network Camera",
}


def position_text(axes: Axes) -> str:
    """The answer to ``query=position``."""
    pan, tilt, zoom = axes
    lines = [f"pan={pan:.4f}", f"tilt={tilt:.4f}", f"zoom={zoom:.0f}", "iris=6427", "focus=8265", "brightness=4999"]
    return _lines([*lines, "autofocus=off", "autoiris=on"])


def limits_text(limits: Limits) -> str:
    """The answer to ``query=limits``."""
    lines = []
    for axis, ends in (("Pan", limits.pan), ("Tilt", limits.tilt), ("Zoom", limits.zoom)):
        if ends is not None:
            lines += [f"Min{axis}={ends[0]:g}", f"Max{axis}={ends[1]:g}"]
    return _lines([*lines, "MinIris=1", "MaxIris=9999", "MinFocus=770", "MaxFocus=9999"])


def attributes_text(zoom_magnification: tuple[tuple[float, float], ...], deg_per_s: float) -> str:
    """The answer to ``query=attributes``: pairs of zoom and magnification, and of speed value and degrees a second."""
    zooms = ",".join(f"{{{zoom:g},{magnification:.4g}}}" for zoom, magnification in zoom_magnification)
    return _lines(["pan=yes", "tilt=yes", "zoom=yes", f"zoomSteps={zooms}", f"speeds={{1,0.05}},{{100,{deg_per_s:g}}}"])


def parameters_text(group: str, limits: Limits) -> str:
    """The answer of ``param.cgi?action=list&group=…``; an unknown group is told so."""
    ends = {"pan": limits.pan or (-170, 170), "tilt": limits.tilt or (-30, 90), "zoom": limits.zoom or (1, 9999)}
    wanted = group if group.startswith("root") else f"root.{group}"
    names = [name for name in _PARAMETERS if f"{name}.".startswith(f"{wanted}.")]
    lines = [f"{name}={_PARAMETERS[name].format(**ends)}" for name in names]
    return _lines(lines or [f"# Error: Error -1 getting param in group '{group}'!"])


def error_text(parameter: str, value: str) -> str:
    """What an unknown query is answered, with status 200."""
    return f"Error:\n{parameter}: unknown value: {value}\n"


def _lines(lines: list[str]) -> str:
    return "".join(f"{line}\r\n" for line in lines)
