"""Logging in as the camera asks: unauthenticated first, then as its ``WWW-Authenticate`` says.

One of these objects serves all requests to a camera, so the nonce is used on and the camera logs one log-in, not
thousands. Digest is that of `requests` (MD5, SHA-256, quality ``auth``), which also takes a new nonce when the camera
calls the old one stale; here it is only told which challenge to answer, and kept from failing on a garbled one.
"""

from __future__ import annotations

import re
import threading
from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, Literal, cast

import requests
from requests.auth import HTTPBasicAuth, HTTPDigestAuth

__all__ = ["CameraLogin", "Challenge", "Scheme", "challenges"]

Scheme = Literal["auto", "digest", "basic"]

_SCHEME = re.compile(r"(?:^|,)\s*(?=(digest|basic)\s+[a-z0-9_-]+\s*=)", re.IGNORECASE)
_PARAMETER = re.compile(r'([a-z0-9_-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,"]+))', re.IGNORECASE)
_STRENGTH = ("SHA-512", "SHA-256", "MD5", "MD5-SESS")


@dataclass(frozen=True)
class Challenge:
    """One way in which a camera asks to log in.

    Attributes
    ----------
    scheme : str
        ``digest`` or ``basic``.
    parameters : dict
        Such as realm, nonce, algorithm, qop; keys in lower case.
    text : str
        As it stood in the header.
    """

    scheme: str
    parameters: dict[str, str]
    text: str

    @property
    def algorithm(self) -> str:
        return self.parameters.get("algorithm", "MD5").upper()

    @property
    def answerable(self) -> bool:
        """Whether a digest challenge has all that an answer takes, and in a form that is known here."""
        qualities = re.split(r"[\s,]+", self.parameters.get("qop", "auth"))
        return {"realm", "nonce"} <= self.parameters.keys() and self.algorithm in _STRENGTH and "auth" in qualities


def challenges(header: str) -> tuple[Challenge, ...]:
    """The challenges in ``WWW-Authenticate``, of which there may be several, in its order."""
    starts = [match.end() for match in _SCHEME.finditer(header)]
    texts = [header[start:end].strip(" ,") for start, end in pairwise([*starts, len(header)])]
    return tuple(_challenge(text) for text in texts)


def _challenge(text: str) -> Challenge:
    scheme, _, rest = text.partition(" ")
    parameters = {key.lower(): quoted or bare for key, quoted, bare in _PARAMETER.findall(rest)}
    return Challenge(scheme.lower(), parameters, text)


class CameraLogin(HTTPDigestAuth):
    """Answers a camera's challenges.

    Basic sends the password as good as in the clear: only over https, or where the site says ``auth = "basic"``.

    Parameters
    ----------
    username, password : str
    scheme : {"auto", "digest", "basic"}
        What the site allows.
    secure : bool
        Whether the camera is spoken with over https.
    """

    def __init__(self, username: str, password: str, scheme: Scheme, secure: bool) -> None:
        super().__init__(username, password)
        self._thread_local = cast(threading.local, SimpleNamespace())  # one nonce for all threads, which take turns
        self._digest_allowed = scheme != "basic"
        self._basic_allowed = scheme == "basic" or (scheme == "auto" and secure)
        self._basic: HTTPBasicAuth | None = None

    def __call__(self, r: requests.PreparedRequest) -> requests.PreparedRequest:
        return self._basic(r) if self._basic else super().__call__(r)  # type: ignore[no-untyped-call]

    def handle_401(self, r: requests.Response, **kwargs: Any) -> requests.Response:
        """Answer a challenge once; a 401 that comes back from here is one that no answer helps."""
        if r.status_code != 401:
            return super().handle_401(r, **kwargs)  # type: ignore[no-untyped-call]
        offered = challenges(r.headers.get("www-authenticate", ""))
        digests = [one for one in offered if one.scheme == "digest" and one.answerable]
        if digests and self._digest_allowed:
            r.headers["www-authenticate"] = min(digests, key=lambda one: _STRENGTH.index(one.algorithm)).text
            return super().handle_401(r, **kwargs)  # type: ignore[no-untyped-call]
        if self._basic_allowed and any(one.scheme == "basic" for one in offered):
            self._basic = HTTPBasicAuth(str(self.username).encode(), str(self.password).encode())
            return self._sent_again(r, **kwargs)
        return r

    def why_not(self, header: str) -> str:
        """What to say of a 401 with this ``WWW-Authenticate``, and what would mend it."""
        offered = {one.scheme for one in challenges(header)}
        if ("digest" in offered and self._digest_allowed) or ("basic" in offered and self._basic_allowed):
            return f"refuses user {self.username!r}: wrong name, or wrong password in the environment variable"
        if "basic" in offered:
            return 'offers only basic, which sends the password in the clear: use https, or allow it by auth = "basic"'
        if "digest" in offered:
            return 'offers only digest: set auth = "digest"'
        return "asks for a log-in without saying how: is this a camera?"

    def _sent_again(self, r: requests.Response, **kwargs: Any) -> requests.Response:
        _ = r.content  # read to its end, so that the connection can serve again
        r.close()
        again = self(r.request.copy())
        answer: requests.Response = r.connection.send(again, **kwargs)
        answer.history.append(r)
        answer.request = again
        return answer
