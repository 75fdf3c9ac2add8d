"""What can go wrong with a camera: the only exceptions that leave a driver. None of them carries a password."""

from __future__ import annotations

__all__ = [
    "BadAnswer",
    "BadPicture",
    "BrokeOff",
    "CameraAway",
    "CameraError",
    "LoginRefused",
    "NotThereInTime",
    "OutsideLimits",
    "Overloaded",
    "Refused",
    "StandsStill",
    "TooLate",
    "TooSlow",
    "Unreachable",
    "Untrusted",
    "without_name",
]


class CameraError(Exception):
    """Something is wrong with a camera; the message names it and says what would mend it where that is known."""


class Unreachable(CameraError):
    """No answer, or a passing failure (502, 503, 504): worth another try."""


class TooLate(Unreachable):
    """No answer, or no whole one, in the time that there was for it."""


class TooSlow(TooLate):
    """It answers, as it did just before, but takes longer for it than there was time."""

    @staticmethod
    def because(answer_s: float, budget_s: float) -> str:
        """What it takes for an answer, and what there was for all of them: a look takes three, a move two and more."""
        return f"an answer takes it {answer_s:.1f} s, and there were {budget_s:.1f} s for all of several"


class CameraAway(Unreachable):
    """Not asked at all: the camera failed too often, or refused the log-in, and is left alone for a while."""


class Overloaded(Unreachable):
    """The camera says that it cannot answer now (502, 503, 504)."""


class BrokeOff(Unreachable):
    """An answer that ended before it was whole."""


class LoginRefused(CameraError):
    """The camera does not take user name and password, or asks for them in a way that the site does not allow."""


class Refused(CameraError):
    """The camera answered that it will not: an ``Error:`` body, or a status such as 400, 403, 404."""


class BadAnswer(CameraError):
    """An answer that is not in the form that the protocol gives it."""


class BadPicture(CameraError):
    """A picture that is no whole JPEG, or was taken while the camera moved."""


class StandsStill(CameraError):
    """It takes commands to move, and tells that it stands where it stood."""


class NotThereInTime(CameraError):
    """It takes commands to move, and answers in time, but is not there when it should be."""


class OutsideLimits(CameraError):
    """Presets that the camera cannot reach; it would clamp them without a word."""


class Untrusted(CameraError):
    """The camera is not who it should be: its certificate is not one that is trusted, or it speaks no TLS."""


def without_name(message: object, camera: str) -> str:
    """What an error says, without the camera's name that it begins with: for where that stands already."""
    return str(message).removeprefix(f"{camera}: ")
