"""What can be wrong with an emulated camera; to be changed at any time while it runs."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Faults"]


@dataclass
class Faults:
    """Faults on demand; all off at first.

    Attributes
    ----------
    latency_s : float
        Every answer comes this much later.
    drop_share : float
        Share of questions, 0 to 1, whose connection is closed without an answer.
    unavailable_share : float
        Share of questions, 0 to 1, that are answered 503.
    wrong_password : bool
        No log-in is right any more.
    frozen : bool
        The position that it tells stays as it was when this was set, while the motors go on.
    pan_drift_deg_per_s : float
        The pan that it tells moves away from the true one, from when this was set.
    pan_slip_deg : float
        Its motors have slipped: it looks that far beside where it goes and tells that it is.
    truncated_picture : bool
        Half of a picture, and then the connection is closed.
    garbled_picture : bool
        Something else than a JPEG, of its length and with its content type.
    reboot_in_move : bool
        The next move is broken off by a reboot, half-way; then this is off again.
    """

    latency_s: float = 0.0
    drop_share: float = 0.0
    unavailable_share: float = 0.0
    wrong_password: bool = False
    frozen: bool = False
    pan_drift_deg_per_s: float = 0.0
    pan_slip_deg: float = 0.0
    truncated_picture: bool = False
    garbled_picture: bool = False
    reboot_in_move: bool = False
