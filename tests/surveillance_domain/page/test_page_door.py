"""Who may see the page: token, cookie, origins of web sockets; by real requests."""

from __future__ import annotations

import base64
import json
import logging
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import requests

pytest.importorskip("bokeh")

from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.model.build import surveillance_model
from surveillance_domain.page.door import TOKEN_VARIABLE, DoorError, allowed_origins, required_token
from surveillance_domain.page.live import LivePage
from surveillance_domain.page.session import Content
from surveillance_domain.site.load import load_site

TOKEN = "a token that nobody guesses"


@pytest.fixture
def session() -> Iterator[requests.Session]:
    with requests.Session() as opened:
        opened.trust_env = False
        yield opened


@pytest.fixture
def content(tmp_path: Path) -> Content:
    site = load_site("tiny")
    return Content(surveillance_model(site, 1), "pomdp", WatchState(site, tmp_path), False, True, False)


def web_socket(session: requests.Session, page: LivePage, origin: str) -> int:
    """The status of the answer to a browser that opens a web socket; 101: it is open."""
    headers = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": base64.b64encode(b"0123456789abcdef").decode(),
        "Origin": origin,
    }
    with session.get(f"{page.url}ws", headers=headers, stream=True, timeout=20) as answer:
        return answer.status_code


@pytest.mark.example
def test_an_address_that_others_reach_needs_a_token(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    for address in ("127.0.0.1", "localhost", "::1", "127.8.8.8"):
        assert required_token(address) is None
    for address in ("0.0.0.0", "::", "192.168.0.5", "cameras.example.org"):
        with pytest.raises(DoorError, match=f"--page-address {address}: .* set {TOKEN_VARIABLE} to 16 characters"):
            required_token(address)
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)
    assert required_token("0.0.0.0") == required_token("127.0.0.1") == TOKEN
    monkeypatch.setenv(TOKEN_VARIABLE, "short")
    with pytest.raises(DoorError, match="5 characters; expected 16 or more") as refused:
        required_token("127.0.0.1")
    assert "short" not in str(refused.value)


@pytest.mark.example
def test_origins_are_the_addresses_of_the_page() -> None:
    assert allowed_origins("127.0.0.1", 5006) == ["127.0.0.1:5006", "localhost:5006"]
    assert allowed_origins("192.168.0.5", 80, ["Cams.example.org", "b.org:443"]) == [
        "192.168.0.5:80",
        "b.org:443",
        "cams.example.org:80",
    ]
    assert "[::1]:5006" in allowed_origins("::1", 5006)
    everywhere = allowed_origins("0.0.0.0", 5006)
    assert "localhost:5006" in everywhere
    assert not any("*" in origin or "0.0.0.0" in origin for origin in everywhere)


@pytest.mark.end_to_end
def test_on_loopback_without_a_token_only_the_page_itself_speaks_with_the_server(
    content: Content, session: requests.Session
) -> None:
    with LivePage(content) as page:
        assert page.url.startswith("http://127.0.0.1:")
        answer = session.get(page.url, timeout=20)
        assert answer.status_code == 200
        assert "<title>tiny: pomdp, 1 target</title>" in answer.text
        own = page.url.rstrip("/")
        assert web_socket(session, page, own) == 101
        for origin in ("http://evil.example", own.replace("127.0.0.1", "127.0.0.2"), f"{own}0", "null"):
            assert web_socket(session, page, origin) == 403


@pytest.mark.end_to_end
def test_the_page_asks_for_the_token_and_for_nothing_less(
    content: Content, session: requests.Session, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    with LivePage(content, token=TOKEN) as page:
        own = page.url.rstrip("/")
        for path in ("", "metadata", "autoload.js?bokeh-autoload-element=1"):
            away = session.get(f"{page.url}{path}", allow_redirects=False, timeout=20)
            assert (away.status_code, away.headers["Location"].partition("?")[0]) == (302, "/login")
        assert web_socket(session, page, own) == 403
        session.cookies.set(f"surveillance_page_{page.port}", "in")  # not signed
        assert session.get(page.url, allow_redirects=False, timeout=20).status_code == 302
        session.cookies.clear()
        form = session.get(page.url, timeout=20)
        assert 'type="password"' in form.text
        wrong = session.post(f"{page.url}login", data={"token": f"{TOKEN}r"}, timeout=20)
        assert (wrong.status_code, "That is not the token." in wrong.text, dict(wrong.cookies)) == (403, True, {})
        right = session.post(f"{page.url}login", data={"token": TOKEN}, allow_redirects=False, timeout=20)
        assert (right.status_code, right.headers["Location"]) == (302, "/")
        cookie = right.headers["Set-Cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        opened = session.get(page.url, timeout=20)
        assert "<title>tiny: pomdp, 1 target</title>" in opened.text
        assert web_socket(session, page, own) == 101
        assert web_socket(session, page, "http://evil.example") == 403
        secret = cookie.partition("=")[2].partition(";")[0].strip('"')
        told = re.search(r'"token":"([^"]+)"', opened.text)
        assert told is not None
        payload = told.group(1).split(".")[0]
        within = base64.urlsafe_b64decode(payload + "=" * (-len(payload) % 4)).decode("latin-1")
        assert json.loads(within)["session_id"]
        for place in (opened.text, within, caplog.text):
            assert TOKEN not in place
            assert secret not in place


@pytest.mark.end_to_end
def test_a_port_that_is_taken_is_told(content: Content) -> None:
    with LivePage(content) as page, pytest.raises(OSError, match="in use"), LivePage(content, port=page.port):
        pass
