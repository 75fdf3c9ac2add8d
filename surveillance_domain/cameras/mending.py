"""What would mend a camera's faults, by the kind of error."""

from __future__ import annotations

__all__ = ["mend_of"]

_MENDS = {
    "Unreachable": "is it switched on and on this network, and are address and port in url those of its web page?",
    "TooLate": "is it switched on, and address and port in url right? else camera or network are overloaded: a longer "
    "step_s, or a smaller image, gives its answers time",
    "TooSlow": "it answers, but too late: a smaller image, fewer who look through it, or a better network make its "
    "answers quicker, and a longer step_s, into which several of them fit, gives them time",
    "Overloaded": "it is there, but starts up or has too much to do: wait a minute; if it stays so, see who else looks "
    "through it, and restart it",
    "BrokeOff": "is the network overloaded, or a cable loose? if it stays so, restart the camera",
    "LoginRefused": "put the password of username into the environment variable that password_env names; after several "
    "wrong tries cameras lock a user out for some minutes",
    "Refused": "is this the camera's address, is channel right, and may username control pan, tilt and zoom?",
    "BadAnswer": "is this an AXIS camera, and the right port? one that expects https answers http like this",
    "BadPicture": "if it stays so, is the network overloaded? restart the camera",
    "StandsStill": "it takes commands and does not turn, or tells a position that is none of now: restart it; if it "
    "stays so, is something in its way, or does somebody else command it?",
    "NotThereInTime": "its moves take longer than the site says (pan_deg_per_s, tilt_deg_per_s, zoom_per_s, settle_s; "
    "or make step_s longer), or its read-back stands still: restart it",
    "OutsideLimits": "turn the camera to where the preset should be and save that with surveillance add-preset",
    "Untrusted": "give the certificate that signed the camera's as ca_file, and in url the name that it was made for; "
    "or http:// if the camera speaks no TLS",
}
_MENDS["CameraAway"] = _MENDS["Unreachable"]


def mend_of(fault: str) -> str:
    """What to try, for the name of one of the classes in `surveillance_domain.cameras.errors`; empty for others."""
    return _MENDS.get(fault, "")
