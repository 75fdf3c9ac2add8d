"""Who may see the page: a token opens it, and other sites' pages cannot reach it through somebody's browser.

The token comes from the environment. It is typed into a form and sent in the body of a POST, so that it stands in no
address and no log; the browser then has a signed cookie that scripts cannot read. On the loopback address a token is
asked for only if there is one.
"""

from __future__ import annotations

import asyncio
import hmac
import ipaddress
import os
import secrets
import socket
from collections.abc import Awaitable, Callable, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bokeh.server.auth_provider import AuthProvider
    from tornado.httputil import HTTPServerRequest

__all__ = ["TOKEN_VARIABLE", "DoorError", "allowed_origins", "door", "required_token"]

TOKEN_VARIABLE = "SURVEILLANCE_PAGE_TOKEN"

_LEAST_CHARACTERS = 16
_COOKIE = "surveillance_page"
_WRONG_WAIT_S = 1.0
_FORM = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Surveillance: log in</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><style>
body {{ font: 18px/1.5 system-ui, sans-serif; max-width: 22rem; margin: 15vh auto 0; padding: 0 1rem; color: #1a1a1a }}
input, button {{ font: inherit; width: 100%; box-sizing: border-box; padding: .4em; margin: .3em 0 }}
p {{ color: #b3261e }}</style></head>
<body><h1>Surveillance</h1>{fault}<form method="post"><label>Token<input type="password" name="token" autofocus
autocomplete="current-password" required></label><button>Open the page</button></form></body></html>"""


class DoorError(ValueError):
    """The page may not be served like this; the message says what would be right."""


def required_token(address: str) -> str | None:
    """The token that the page asks for; ``None``: none.

    Raises
    ------
    DoorError
        If there is none although others than this machine can reach the address, or if it is short.
    """
    token = os.environ.get(TOKEN_VARIABLE) or None
    if token is None and not _is_loopback(address):
        raise DoorError(
            f"--page-address {address}: others can reach the page there, so it needs a token: "
            f"set {TOKEN_VARIABLE} to {_LEAST_CHARACTERS} characters or more"
        )
    if token is not None and len(token) < _LEAST_CHARACTERS:
        raise DoorError(f"{TOKEN_VARIABLE}: {len(token)} characters; expected {_LEAST_CHARACTERS} or more")
    return token


def allowed_origins(address: str, port: int, also: Sequence[str] = ()) -> list[str]:
    """``host:port`` of every address under which a browser may have opened the page that speaks with this server.

    Parameters
    ----------
    address : str
        That is bound; for 0.0.0.0 and :: the machine's names, and its own addresses as far as it knows them.
    also : sequence of str
        Others, such as ``cameras.example.org`` or ``cameras.example.org:443``; without a port: the page's own.
    """
    if _is_loopback(address):
        hosts = {address, "localhost", "127.0.0.1"}
    elif address in ("0.0.0.0", "::"):
        hosts = {"localhost", "127.0.0.1", socket.gethostname(), socket.getfqdn(), *_own_addresses()}
    else:
        hosts = {address}
    named = {one if ":" in one.rpartition("]")[2] else f"{one}:{port}" for one in also}
    return sorted({f"{_bracketed(host).lower()}:{port}" for host in hosts} | {one.lower() for one in named})


def door(token: str, port: int) -> tuple[AuthProvider, bytes]:
    """What asks for the token, and the secret that signs its cookies; another one in every process."""
    from bokeh.server.auth_provider import AuthProvider
    from tornado.web import HTTPError, RequestHandler

    cookie = f"{_COOKIE}_{port}"

    class LogIn(RequestHandler):
        """Asks for the token."""

        def get(self) -> None:
            self.finish(_FORM.format(fault=""))

        async def post(self) -> None:
            given = self.get_body_argument("token", "")
            if hmac.compare_digest(given.encode(), token.encode()):
                self.set_signed_cookie(cookie, "in", httponly=True, samesite="Strict", expires_days=None)
                self.redirect("/")
                return
            await asyncio.sleep(_WRONG_WAIT_S)
            self.set_status(403)
            self.finish(_FORM.format(fault="<p>That is not the token.</p>"))

    class Door(AuthProvider):  # type: ignore[misc]  # bokeh has no types
        """Lets in whoever has the cookie; a web socket without it is refused before it opens."""

        @property
        def get_user(self) -> None:
            return None

        @property
        def get_user_async(self) -> Callable[[Any], Awaitable[str | None]]:
            async def user(handler: RequestHandler) -> str | None:
                if handler.get_signed_cookie(cookie) is not None:
                    return "in"
                if handler.request.headers.get("Upgrade", "").lower() == "websocket":
                    raise HTTPError(403)
                return None

            return user

        @property
        def login_url(self) -> str:
            return "/login"

        @property
        def get_login_url(self) -> Callable[[HTTPServerRequest], str] | None:
            return None

        @property
        def login_handler(self) -> type[RequestHandler]:
            return LogIn

        @property
        def logout_url(self) -> None:
            return None

        @property
        def logout_handler(self) -> None:
            return None

    return Door(), secrets.token_bytes(32)


def _is_loopback(address: str) -> bool:
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def _own_addresses() -> set[str]:
    try:
        return {str(info[4][0]).partition("%")[0] for info in socket.getaddrinfo(socket.gethostname(), None)}
    except OSError:
        return set()


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
