"""What shall go wrong with emulated cameras, and when, as people write it."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from factored_pomdp.errors import did_you_mean

__all__ = ["GUARD_TOUR", "JOYSTICK", "KINDS", "PlannedFault", "REBOOT", "read_plan"]

REBOOT, JOYSTICK, GUARD_TOUR = "reboot", "joystick", "guard_tour"
_PUSH_S = 3.0
_FORM = re.compile(r"(?P<kind>[\w-]*)(?:=(?P<value>[^@]*))?(?:@(?P<begins>[^-@]*)(?:-(?P<ends>[^@]*))?)?")


@dataclass(frozen=True)
class _Kind:
    """What may be said of a kind of fault: least and greatest value, if it takes one, and what is meant without."""

    range: tuple[float, float] | None = None
    default: float | None = None


KINDS = {
    "latency_s": _Kind((0.0, 3600.0)),
    "drop_share": _Kind((0.0, 1.0)),
    "unavailable_share": _Kind((0.0, 1.0)),
    "wrong_password": _Kind(),
    "frozen": _Kind(),
    "pan_drift_deg_per_s": _Kind((-360.0, 360.0)),
    "pan_slip_deg": _Kind((-180.0, 180.0)),
    "truncated_picture": _Kind(),
    "garbled_picture": _Kind(),
    "reboot_in_move": _Kind(),
    REBOOT: _Kind(),
    JOYSTICK: _Kind((-360.0, 360.0), 10.0),
    GUARD_TOUR: _Kind((0.1, 3600.0), 5.0),
}
"""The fields of `surveillance_domain.emulation.faults.Faults`; a reboot there and then; and moves by people: a joystick
that is pushed (degrees a second, 10), a guard tour from preset to preset (seconds at each, 5)."""


@dataclass(frozen=True)
class PlannedFault:
    """One thing that goes wrong for a while.

    Attributes
    ----------
    camera, kind : str
        The kind is one of `KINDS`.
    value : float or None
        ``None`` for those that are on or off.
    begins_s, ends_s : float
        Seconds after the start; it ends at infinity if it does not, and a reboot as soon as it begins.
    """

    camera: str
    kind: str
    value: float | None
    begins_s: float
    ends_s: float

    def __str__(self) -> str:
        return f"{self.camera}: {self.kind}" + ("" if self.value is None else f"={self.value:g}")


def read_plan(texts: Sequence[str], cameras: Sequence[str]) -> tuple[PlannedFault, ...]:
    """Faults as people write them: ``CAMERA:KIND[=VALUE][@SECONDS[-SECONDS]]``.

    Raises
    ------
    ValueError
        Saying what would be right, for the first that is wrong, or two of one kind at one camera at one time.
    """
    plan = tuple(_fault(text, cameras) for text in texts)
    for (one, first), (other, second) in combinations(zip(plan, texts, strict=True), 2):
        if (one.camera, one.kind) == (other.camera, other.kind):
            later, earlier = max(one.begins_s, other.begins_s), min(one.ends_s, other.ends_s)
            if later < earlier or one.begins_s == other.begins_s:
                raise ValueError(f"--fault {first} and --fault {second}: both at once; expected one after the other")
    return plan


def _fault(text: str, cameras: Sequence[str]) -> PlannedFault:
    where = f"--fault {text}"
    named = [name for name in cameras if text.startswith(f"{name}:")]
    if not named:
        if ":" not in text:
            raise ValueError(
                f"{where}: expected CAMERA:KIND[=VALUE][@SECONDS[-SECONDS]], such as north:latency_s=2@30-60"
            )
        name = text.partition(":")[0]
        raise ValueError(f"{where}: no camera {name!r}{did_you_mean(name, cameras)}")
    camera = max(named, key=len)
    found = _FORM.fullmatch(text.removeprefix(f"{camera}:"))
    if found is None:
        raise ValueError(
            f"{where}: expected KIND[=VALUE][@SECONDS[-SECONDS]] after the camera, such as latency_s=2@30-60"
        )
    kind = found["kind"].replace("-", "_")
    if kind not in KINDS:
        raise ValueError(f"{where}: no kind of fault {kind!r}{did_you_mean(kind, KINDS)}")
    begins_s = 0.0 if found["begins"] is None else _number(where, "seconds", found["begins"], 0.0, math.inf)
    if found["ends"] is None:
        ends_s = {REBOOT: begins_s, JOYSTICK: begins_s + _PUSH_S}.get(kind, math.inf)
    elif kind == REBOOT:
        raise ValueError(f"{where}: a reboot ends by itself, after 45 s; expected no second time")
    else:
        ends_s = _number(where, "seconds", found["ends"], 0.0, math.inf)
        if ends_s <= begins_s:
            raise ValueError(f"{where}: ends at {ends_s:g} s; expected later than {begins_s:g} s, where it begins")
    return PlannedFault(camera, kind, _value(where, kind, found["value"]), begins_s, ends_s)


def _value(where: str, kind: str, text: str | None) -> float | None:
    allowed = KINDS[kind]
    if allowed.range is None:
        if text is not None:
            raise ValueError(f"{where}: {kind} takes no value; expected {kind} alone")
        return None
    if text is None:
        if allowed.default is None:
            low, high = allowed.range
            raise ValueError(f"{where}: {kind} without a value; expected {kind}=NUMBER, {low:g} to {high:g}")
        return allowed.default
    return _number(where, kind, text, *allowed.range)


def _number(where: str, what: str, text: str, low: float, high: float) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and low <= number <= high):
        expected = f"a number, {low:g} to {high:g}" if math.isfinite(high) else f"a number, {low:g} or more"
        raise ValueError(f"{where}: {what}: found {text!r}; expected {expected}")
    return number
