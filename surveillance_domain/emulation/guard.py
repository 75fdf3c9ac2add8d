"""The camera's side of a log-in: digest as AXIS cameras send it, and basic."""

from __future__ import annotations

import base64
import hashlib
import hmac
import re
import threading
from collections import OrderedDict
from collections.abc import Sequence

import numpy as np

from surveillance_domain.cameras.clock import Clock

__all__ = ["Guard"]

_PARAMETER = re.compile(r'(\w+)=(?:"([^"]*)"|([^\s,]+))')
_HASHES = {"MD5": "md5", "SHA-256": "sha256"}
_MOST_NONCES = 256


class Guard:
    """Lets in who knows the password.

    Parameters
    ----------
    realm : str
        Such as ``AXIS_ACCC8E000001``.
    username, password : str
    clock : Clock
    rng : numpy.random.Generator
        For nonces.
    offers : sequence of str
        What it asks for, in this order: ``MD5``, ``SHA-256`` (digest with either) and ``basic``.
    nonce_s : float
        For how long a nonce is good; after that it is called stale.
    """

    def __init__(
        self,
        realm: str,
        username: str,
        password: str,
        clock: Clock,
        rng: np.random.Generator,
        offers: Sequence[str] = ("MD5",),
        nonce_s: float = 3600.0,
    ) -> None:
        self._realm, self._username, self._password = realm, username, password
        self._clock, self._rng, self._offers, self._nonce_s = clock, rng, tuple(offers), nonce_s
        self._given: OrderedDict[str, float] = OrderedDict()
        self._counts: dict[str, int] = {}
        self._lock = threading.Lock()
        self.refusals = 0

    def __repr__(self) -> str:
        return f"Guard({self._realm!r})"

    def forget(self) -> None:
        """After a reboot no nonce is known."""
        with self._lock:
            self._given.clear()
            self._counts.clear()

    def refuses(self, method: str, target: str, authorization: str | None) -> list[str] | None:
        """``None``: come in; otherwise the challenges to send with the 401.

        Parameters
        ----------
        method, target : str
            ``GET`` and the path with its query, as asked.
        authorization : str or None
            The header.
        """
        scheme, _, rest = (authorization or "").partition(" ")
        with self._lock:
            if scheme.lower() == "basic" and "basic" in self._offers:
                right = base64.b64encode(f"{self._username}:{self._password}".encode()).decode()
                return None if hmac.compare_digest(rest.strip(), right) else self._challenges(stale=False)
            if scheme.lower() != "digest":
                return self._challenges(stale=False)
            found = {key.lower(): quoted or bare for key, quoted, bare in _PARAMETER.findall(rest)}
            if not self._knows(method, target, found):
                return self._challenges(stale=False)
            return None if self._fresh(found) else self._challenges(stale=True)

    def _knows(self, method: str, target: str, found: dict[str, str]) -> bool:
        """Whether the answer was made with the password, for this question."""
        algorithm = found.get("algorithm", "MD5").upper()
        if algorithm not in self._offers or found.get("uri") != target or found.get("qop") != "auth":
            return False
        secret = _hashed(algorithm, f"{self._username}:{self._realm}:{self._password}")
        question = _hashed(algorithm, f"{method}:{target}")
        between = ":".join(found.get(key, "") for key in ("nonce", "nc", "cnonce", "qop"))
        return hmac.compare_digest(
            found.get("response", "").encode(), _hashed(algorithm, f"{secret}:{between}:{question}").encode()
        )

    def _fresh(self, found: dict[str, str]) -> bool:
        """Whether the nonce is one of ours, young, and not used with this count before."""
        nonce, count = found.get("nonce", ""), found.get("nc", "")
        given = self._given.get(nonce)
        if given is None or self._clock.now() - given > self._nonce_s or not re.fullmatch(r"[0-9a-f]{8}", count):
            return False
        if int(count, 16) <= self._counts.get(nonce, 0):
            return False
        self._counts[nonce] = int(count, 16)
        return True

    def _challenges(self, stale: bool) -> list[str]:
        self.refusals += 1
        headers = []
        for offer in self._offers:
            if offer == "basic":
                headers.append(f'Basic realm="{self._realm}"')
                continue
            nonce = self._rng.bytes(24).hex()
            self._given[nonce] = self._clock.now()
            text = f'Digest realm="{self._realm}", nonce="{nonce}", algorithm={offer}, qop="auth"'
            headers.append(text + (", stale=true" if stale else ""))
        while len(self._given) > _MOST_NONCES:
            self._counts.pop(self._given.popitem(last=False)[0], None)
        return headers


def _hashed(algorithm: str, text: str) -> str:
    return hashlib.new(_HASHES[algorithm], text.encode(), usedforsecurity=False).hexdigest()
