"""One question to a camera and its answer over HTTP: deadlines, a cap on bytes, and every failure as an error of ours.

Errors are raised when those of the libraries are out of sight, so that none of them, with the headers of the request
that it holds, hangs on to ours.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from http.client import HTTPException, IncompleteRead
from typing import TYPE_CHECKING

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import (
    BadAnswer,
    BrokeOff,
    CameraError,
    LoginRefused,
    Overloaded,
    Refused,
    TooLate,
    Unreachable,
    Untrusted,
)
from surveillance_domain.cameras.rests import Lockout

if TYPE_CHECKING:
    import requests

    from surveillance_domain.cameras.authentication import CameraLogin

__all__ = ["Answer", "Exchange"]

_PASSING = frozenset({502, 503, 504})
_MOST_TEXT_BYTES = 1_000_000
_CHUNK_BYTES = 65_536


@dataclass(frozen=True)
class Answer:
    """A body that came whole, with a status of 2xx, which says nothing yet: it may be an ``Error:``.

    Attributes
    ----------
    status : int
    body : bytes
    date : str
        The header; empty where there was none.
    """

    status: int
    body: bytes
    date: str = ""

    @property
    def text(self) -> str:
        return self.body.decode("utf-8", errors="replace")


class Exchange:
    """The HTTP side of one camera: one session, one log-in.

    Parameters
    ----------
    name : str
        The camera's, for messages.
    url : str
        Such as ``http://192.168.0.90``.
    session : requests.Session
    login : CameraLogin or None
        ``None`` where the site gives no user.
    clock : Clock
    connect_timeout_s, read_timeout_s : float
        Cut short where the deadline comes first.
    """

    def __init__(
        self,
        name: str,
        url: str,
        session: requests.Session,
        login: CameraLogin | None,
        clock: Clock,
        connect_timeout_s: float,
        read_timeout_s: float,
    ) -> None:
        self._name, self._url, self._session, self._login, self._clock = name, url.rstrip("/"), session, login, clock
        self._timeouts_s = (connect_timeout_s, read_timeout_s)
        self.lockout = Lockout(clock)

    def __repr__(self) -> str:
        return f"Exchange({self._name!r}, {self._url!r})"

    def close(self) -> None:
        """Let go of the connection."""
        self._session.close()

    def get(self, path: str, query: Mapping[str, str], until: float, most_bytes: int = _MOST_TEXT_BYTES) -> Answer:
        """Ask once.

        Parameters
        ----------
        path : str
            Such as ``/axis-cgi/com/ptz.cgi``.
        query : dict
        until : float
            Deadline on the clock, for the whole of it.
        most_bytes : int
            A longer body is not read to its end.

        Raises
        ------
        CameraError
            `Unreachable`, `Untrusted`, `LoginRefused`, `Refused` or `BadAnswer`.
        """
        import requests
        from urllib3.exceptions import HTTPError

        failure: CameraError
        try:
            return self._ask(path, query, until, most_bytes)
        except CameraError:
            raise
        except requests.exceptions.SSLError as error:
            failure = Untrusted(
                f"{self._name}: no TLS with {self._url} ({_root(error)}); is ca_file its certificate's?"
            )
        except (requests.exceptions.Timeout, TimeoutError):
            failure = TooLate(f"{self._name}: no answer from {self._url} in time")
        except (requests.exceptions.ConnectionError, requests.exceptions.ChunkedEncodingError, HTTPError) as error:
            failure = self._unanswered(error)
        except (OSError, HTTPException) as error:
            failure = Unreachable(f"{self._name}: no answer from {self._url} ({_root(error)})")
        except Exception as error:  # whatever else the libraries stumble over in an answer
            failure = BadAnswer(f"{self._name}: {self._url} gives an answer that is not HTTP ({_root(error)})")
        raise failure

    def _unanswered(self, error: Exception) -> Unreachable:
        cut = _cut_short(error)
        if cut is not None:
            return BrokeOff(f"{self._name}: an answer from {self._url} broke off after {cut:,} bytes")
        return Unreachable(f"{self._name}: no answer from {self._url} ({_root(error)})")

    def _ask(self, path: str, query: Mapping[str, str], until: float, most_bytes: int) -> Answer:
        left = until - self._clock.now()
        if left <= 0:
            raise TooLate(f"{self._name}: no time left to ask {self._url}")
        connect_s, read_s = (min(limit, left) for limit in self._timeouts_s)
        response = self._session.get(
            self._url + path,
            params=dict(query),
            auth=self._login,
            timeout=(connect_s, read_s),
            stream=True,
            allow_redirects=False,
        )
        try:
            self.lockout.heard([*(earlier.status_code for earlier in response.history), response.status_code])
            self._check_status(response)
            date = response.headers.get("date", "")
            return Answer(response.status_code, self._body(response, until, most_bytes), date)
        finally:
            response.close()

    def _check_status(self, response: requests.Response) -> None:
        status = response.status_code
        if status == 401:
            header = response.headers.get("www-authenticate", "")
            because = self._login.why_not(header) if self._login else "asks for a log-in; set username and password_env"
            raise LoginRefused(f"{self._name}: {self._url} {because}")
        if status in _PASSING:
            raise Overloaded(f"{self._name}: {self._url} answers {status}")
        if 300 <= status < 400:
            elsewhere = response.headers.get("location", "elsewhere")[:200]
            raise Refused(f"{self._name}: {self._url} sends us to {elsewhere!r}; put the right address into url")
        if not 200 <= status < 300:
            raise Refused(f"{self._name}: {self._url} answers {status}")

    def _body(self, response: requests.Response, until: float, most_bytes: int) -> bytes:
        """All of the body, read as it comes; where more than one read is needed, the deadline cuts them off."""
        length = response.headers.get("content-length", "")
        expected = int(length) if length.isdecimal() else None
        cut = threading.Event()

        def shut() -> None:
            cut.set()
            with suppress(ValueError, RuntimeError):  # it ended in this very moment
                response.raw.shutdown()

        body = bytearray(response.raw.read1(_CHUNK_BYTES, decode_content=False))
        more = len(body) != expected
        with self._clock.alarm(until - self._clock.now(), shut) if more else nullcontext():
            while chunk := response.raw.read1(_CHUNK_BYTES, decode_content=False):
                body += chunk
                if len(body) > most_bytes:
                    raise BadAnswer(f"{self._name}: an answer of more than {most_bytes:,} bytes")
        if cut.is_set() or self._clock.now() > until:
            raise TooLate(f"{self._name}: the answer did not end in time")
        return bytes(body)


def _cut_short(error: BaseException) -> int | None:
    """How many bytes there were of an answer that was to have more; ``None`` for other errors."""
    for inner in (error, *error.args):
        if isinstance(inner, IncompleteRead):
            return inner.partial if isinstance(inner.partial, int) else len(inner.partial)
        if isinstance(inner, BaseException) and inner is not error:
            found = _cut_short(inner)
            if found is not None:
                return found
    return None


def _root(error: BaseException) -> str:
    """The innermost reason, such as ``Connection refused``, without what stands before it."""
    reason: BaseException = error
    while True:
        inner = getattr(reason, "reason", None) or (reason.args[-1] if reason.args else None)
        if not isinstance(inner, BaseException):
            break
        reason = inner
    last = reason.args[-1] if reason.args else type(reason).__name__
    text = last if isinstance(last, str) else str(reason)
    return " ".join(text.rpartition(": ")[2].rpartition("] ")[2].split())
