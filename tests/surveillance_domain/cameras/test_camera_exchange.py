"""Answers that come in pieces, too long, too late, broken, or from something that is no camera."""

from __future__ import annotations

import ssl
import subprocess
import threading
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.cameras.errors import BadAnswer, BadPicture, CameraError, Refused, Unreachable, Untrusted
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.cameras.vapix import VapixCamera
from tests.emulated_cameras import described, emulated_pair, jpeg, raw_server


def driver_of(url: str, **changes: object) -> VapixCamera:
    return open_camera(described(url, username=None, **changes), RealClock(), np.random.default_rng(0))


def ok(body: bytes, length: int | None = None, content_type: str = "text/plain") -> bytes:
    size = len(body) if length is None else length
    head = f"HTTP/1.1 200 OK\r\nContent-Type: {content_type}\r\nContent-Length: {size}\r\nConnection: close\r\n\r\n"
    return head.encode() + body


def status(code: int, header: str = "") -> bytes:
    return f"HTTP/1.1 {code} X\r\n{header}Content-Length: 0\r\nConnection: close\r\n\r\n".encode()


@pytest.mark.end_to_end
def test_a_body_without_length_ends_with_the_connection() -> None:
    with raw_server(b"HTTP/1.0 200 OK\r\n\r\npan=1.5\r\ntilt=0.0\r\n") as url:
        assert driver_of(url).position(5.0) == Position(1.5, 0.0)


@pytest.mark.end_to_end
def test_an_error_with_status_200_is_a_refusal_and_not_tried_again() -> None:
    body = b"Error:\nquery: unknown value: position\n"
    with raw_server(ok(body), ok(b"pan=0\ntilt=0\n")) as url, pytest.raises(Refused, match=r"north: .*unknown value"):
        driver_of(url).position(5.0)


@pytest.mark.end_to_end
@pytest.mark.parametrize("code", [400, 403, 404, 500])
def test_other_failures_are_not_tried_again(code: int) -> None:
    with raw_server(status(code), ok(b"pan=0\ntilt=0\n")) as url, pytest.raises(Refused, match=str(code)):
        driver_of(url).position(5.0)


@pytest.mark.end_to_end
@pytest.mark.parametrize("first", [status(502), status(503), status(504), b"", ok(b"pan=", 20)])
def test_passing_failures_are_tried_again(first: bytes) -> None:
    with raw_server(first, ok(b"pan=0\ntilt=0\n")) as url:
        assert driver_of(url).position(5.0) == Position(0.0, 0.0)


@pytest.mark.end_to_end
def test_a_redirect_is_not_followed() -> None:
    answer = status(301, "Location: https://elsewhere/\r\n")
    with raw_server(answer) as url, pytest.raises(Refused, match="'https://elsewhere/'; put the right address"):
        driver_of(url).position(5.0)


@pytest.mark.end_to_end
def test_nobody_listens() -> None:
    with raw_server(b"") as url:
        pass
    with pytest.raises(Unreachable, match=r"north: no answer from http://127.0.0.1:\d+ \(Connection refused\)"):
        driver_of(url).position(0.05)


@pytest.mark.end_to_end
def test_a_body_that_trickles_is_cut_off_at_the_deadline() -> None:
    with raw_server(ok(b"pan=0\ntilt=0\n", 100_000), slowly_s=0.002) as url:
        driver = driver_of(url, read_timeout_s=60.0)
        before = driver._clock.now()
        with pytest.raises(Unreachable):
            driver.position(1.0)
        assert driver._clock.now() - before < 10.0


@pytest.mark.end_to_end
def test_a_flood_is_not_read_to_its_end() -> None:
    flood = b"HTTP/1.0 200 OK\r\n\r\n" + b"pan=1\n" * 500_000
    with raw_server(flood) as url, pytest.raises(BadAnswer, match="more than 1,000,000 bytes"):
        driver_of(url).position(20.0)


@pytest.mark.end_to_end
def test_a_certificate_that_nobody_signed_and_the_file_that_mends_it(tmp_path: Path) -> None:
    key, certificate = tmp_path / "key.pem", tmp_path / "north.pem"
    asked = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=127.0.0.1"]
    for_files = ["-keyout", key, "-out", certificate, "-addext", "subjectAltName=IP:127.0.0.1"]
    made = subprocess.run([*asked, *for_files], capture_output=True, check=False)
    if made.returncode != 0:
        pytest.skip("openssl cannot make a certificate here")
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    with emulated_pair() as pair:
        server = pair.server._server
        server.socket = context.wrap_socket(server.socket, server_side=True)
        url = pair.server.url.replace("http:", "https:")

        def driver(**changes: object) -> VapixCamera:
            description = described(url, **changes)
            return open_camera(
                description, RealClock(), np.random.default_rng(0), folder=tmp_path, password="pa55-wörd"
            )

        with pytest.raises(Untrusted, match="certificate"):
            driver().position(5.0)
        trusting = driver(ca_file="north.pem")
        assert trusting.position(5.0) == Position(-20.0, -40.0, 1.0)
        trusting.close()
    with raw_server(b"HTTP/1.0 400 Bad\r\n\r\n") as url, pytest.raises(Untrusted, match="no TLS"):
        driver_of(url.replace("http:", "https:")).position(5.0)


PICTURE = jpeg(32, 24)

broken_pictures = st.one_of(
    st.integers(0, len(PICTURE) - 1).map(lambda end: PICTURE[:end]),
    st.tuples(st.integers(0, len(PICTURE) - 1), st.binary(min_size=1, max_size=12)).map(
        lambda at: PICTURE[: at[0]] + at[1] + PICTURE[at[0] + len(at[1]) :]
    ),
    st.binary(max_size=40).map(lambda tail: b"\xff\xd8\xff" + tail),
)
headers = st.lists(
    st.tuples(
        st.sampled_from(["Content-Length", "Content-Type", "Location", "Set-Cookie", "Transfer-Encoding", "X", ""]),
        st.sampled_from([": ", ":", "", " : "]),
        st.one_of(
            st.text(alphabet=st.characters(max_codepoint=255), max_size=12),
            st.sampled_from(["chunked", "-1", "5", "a=b", "http://[", "gzip"]),
        ),
        st.sampled_from(["\r\n", "\n", "\r", "\r\n "]),
    ).map("".join),
    max_size=4,
).map(lambda rows: "".join(rows).encode("latin-1"))
bodies = st.one_of(
    st.binary(max_size=60),
    broken_pictures,
    st.sampled_from([b"pan=1\ntilt=0\n", b"Error:\n", PICTURE, b"5\r\npan=1\r\n0\r\n\r\n"]),
)
whole = st.one_of(
    st.binary(max_size=60),
    st.tuples(st.sampled_from([100, 200, 204, 206, 301, 304, 401, 404, 503, 999]), headers, bodies).map(
        lambda parts: f"HTTP/1.1 {parts[0]} X\r\n".encode() + parts[1] + b"Connection: close\r\n\r\n" + parts[2]
    ),
)


@pytest.mark.property
@settings(max_examples=60)
@given(whole)
def test_whatever_comes_no_foreign_error_leaves_the_driver(answer: bytes) -> None:
    with raw_server(answer) as url, emulated_pair(url=url) as pair:
        for ask in (pair.driver.position, pair.driver.picture, pair.driver.start, pair.driver.attributes):
            with suppress(CameraError):
                ask(0.02)
        move = pair.driver.move(pair.right, 0.02)
        assert move.outcome.value in ("timed out", "unreachable", "stalled")


@pytest.mark.property
@settings(max_examples=150)
@given(broken_pictures)
def test_broken_pictures_are_found_or_are_whole_all_the_same(body: bytes) -> None:
    from surveillance_domain.cameras.pictures import jpeg_size

    with suppress(BadPicture, Refused):
        width, height = jpeg_size(body)
        assert width * height > 0


@pytest.mark.end_to_end
def test_drivers_leave_no_thread_behind() -> None:
    before = threading.active_count()
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.driver.picture(5.0)
    deadline = RealClock().now() + 5.0
    while threading.active_count() > before and RealClock().now() < deadline:
        RealClock().sleep(0.01)
    assert threading.active_count() <= before
