"""Logging in to a real HTTP server that asks as AXIS cameras do."""

from __future__ import annotations

import base64
import logging
import traceback

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.authentication import CameraLogin, challenges
from surveillance_domain.cameras.base import HealthState
from surveillance_domain.cameras.errors import CameraAway, CameraError, LoginRefused
from tests.emulated_cameras import PASSWORD, emulated_pair, raw_server

RECORDED = 'Digest realm="AXIS_WS_ACCC8E494578", nonce="t6fuOp51BQA=f644", algorithm=MD5, qop="auth"'


@pytest.mark.example
def test_challenges_of_one_header_and_of_several_joined() -> None:
    (one,) = challenges(RECORDED)
    assert one.scheme == "digest"
    assert one.parameters == {
        "realm": "AXIS_WS_ACCC8E494578",
        "nonce": "t6fuOp51BQA=f644",
        "algorithm": "MD5",
        "qop": "auth",
    }
    assert one.answerable
    joined = (
        f'Basic realm="AXIS, or so", {RECORDED}, Digest realm="b", nonce="c", algorithm=SHA-256, qop="auth,auth-int"'
    )
    basic, first, second = challenges(joined)
    assert (basic.scheme, basic.parameters) == ("basic", {"realm": "AXIS, or so"})
    assert first.text == RECORDED
    assert (second.algorithm, second.answerable) == ("SHA-256", True)


@pytest.mark.example
@pytest.mark.parametrize(
    "header",
    [
        'Digest realm="a"',
        'Digest nonce="a"',
        'Digest realm="a", nonce="b", algorithm=ROT13',
        'Digest realm="a", nonce="b", qop="auth-int"',
    ],
)
def test_challenges_without_answer(header: str) -> None:
    assert [one.answerable for one in challenges(header)] == [False]


@pytest.mark.property
@given(
    st.one_of(
        st.text(), st.lists(st.sampled_from(["Digest ", "Basic ", "realm=", '"', ",", "=", "a", " "])).map("".join)
    )
)
def test_any_header_is_taken_apart(header: str) -> None:
    for challenge in challenges(header):
        assert challenge.scheme in ("digest", "basic")
        assert challenge.text in header
    assert CameraLogin("a", "b", "auto", secure=True).why_not(header)


@pytest.mark.end_to_end
@pytest.mark.parametrize("offers", [("MD5",), ("SHA-256",), ("MD5", "SHA-256"), ("basic", "SHA-256", "MD5")])
def test_one_log_in_serves_all_questions(offers: tuple[str, ...]) -> None:
    with emulated_pair(offers=offers) as pair:
        pair.driver.start(5.0)
        for _ in range(20):
            pair.driver.position(1.0)
        assert pair.camera.guard.refusals == 1
        assert pair.server.connections == 2  # the camera closes the one on which it asked for the log-in
        assert pair.driver.health.failures == 0


@pytest.mark.end_to_end
def test_a_stale_nonce_is_renewed_without_a_failure() -> None:
    with emulated_pair(nonce_s=10.0) as pair:
        for _ in range(6):
            pair.driver.position(1.0)
            pair.clock.sleep(6.0)
        assert pair.camera.guard.refusals == 3  # at 0, 12 and 24 seconds
        assert pair.driver.health.failures == 0


@pytest.mark.end_to_end
def test_a_wrong_password_is_tried_once_in_ten_minutes() -> None:
    with emulated_pair(password="wrong") as pair:
        with pytest.raises(LoginRefused, match="refuses user 'operator': wrong name, or wrong password"):
            pair.driver.position(1.0)
        assert pair.camera.questions == 2
        assert pair.driver.health.state is HealthState.LOCKED_OUT
        assert pair.driver.health.returns_s == 600.0
        pair.clock.sleep(599.0)
        with pytest.raises(CameraAway, match=r"^north: left alone for another 1 s; http\S+ refuses user"):
            pair.driver.position(1.0)
        assert pair.camera.questions == 2
        pair.clock.sleep(1.0)
        with pytest.raises(LoginRefused):
            pair.driver.position(1.0)
        assert pair.camera.questions == 4
        with pytest.raises(CameraAway):
            pair.driver.position(1.0)
        assert pair.camera.questions == 4


@pytest.mark.end_to_end
def test_a_password_that_is_changed_back_is_taken_after_the_pause() -> None:
    with emulated_pair() as pair:
        pair.driver.position(1.0)
        pair.camera.faults.wrong_password = True
        with pytest.raises(LoginRefused):
            pair.driver.position(1.0)
        pair.camera.faults.wrong_password = False
        pair.clock.sleep(600.0)
        assert pair.driver.position(1.0) == pair.left
        assert pair.driver.health.state is HealthState.READY


@pytest.mark.end_to_end
def test_basic_only_over_https_or_by_name() -> None:
    with emulated_pair(offers=("basic",)) as pair:
        with pytest.raises(LoginRefused, match=r'offers only basic.*auth = "basic"'):
            pair.driver.position(1.0)
        assert pair.camera.questions == 1  # the password was not sent
    with emulated_pair(offers=("basic",), auth="digest") as pair, pytest.raises(LoginRefused, match="only basic"):
        pair.driver.position(1.0)
    with emulated_pair(offers=("basic",), auth="basic") as pair:
        for _ in range(3):
            assert pair.driver.position(1.0) == pair.left
        assert pair.camera.guard.refusals == 1
    with emulated_pair(auth="basic") as pair, pytest.raises(LoginRefused, match='only digest: set auth = "digest"'):
        pair.driver.position(1.0)


@pytest.mark.end_to_end
def test_a_camera_without_user_is_told_what_is_missing() -> None:
    with emulated_pair(username=None) as pair, pytest.raises(LoginRefused, match="set username and password_env"):
        pair.driver.position(1.0)


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    "header",
    ["", "WWW-Authenticate: Digest\r\n", "WWW-Authenticate: Negotiate\r\n", 'WWW-Authenticate: Digest realm="\r\n'],
)
def test_a_garbled_challenge_is_a_refused_log_in(header: str) -> None:
    answer = f"HTTP/1.1 401 Unauthorized\r\n{header}Content-Length: 0\r\nConnection: close\r\n\r\n"
    with raw_server(answer.encode()) as url, emulated_pair(url=url) as pair, pytest.raises(LoginRefused):
        pair.driver.position(1.0)


def everything_said(error: BaseException) -> str:
    """Text of an error, of its attributes, and of all errors that hang on it."""
    said, seen, left = [], set(), [error]
    while left:
        one = left.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        said += [str(one), repr(one), repr(vars(one)), "".join(traceback.format_exception(one))]
        for name in ("request", "response"):
            said.append(repr(vars(getattr(one, name))) if getattr(one, name, None) is not None else "")
        left += [other for other in (one.__cause__, one.__context__) if other is not None]
    return "\n".join(said)


@pytest.mark.end_to_end
@pytest.mark.parametrize(("offers", "auth"), [(("MD5",), "auto"), (("basic",), "basic")])
@pytest.mark.parametrize("fault", ["wrong", "dropped", "unavailable", "late", "garbled"])
def test_the_password_is_never_told(
    offers: tuple[str, ...], auth: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    with emulated_pair(offers=offers, auth=auth) as pair:
        pair.driver.position(1.0)
        faults = pair.camera.faults
        faults.wrong_password = fault == "wrong"
        faults.drop_share = float(fault == "dropped")
        faults.unavailable_share = float(fault == "unavailable")
        faults.latency_s = 9.0 if fault == "late" else 0.0
        faults.garbled_picture = fault == "garbled"
        with pytest.raises(CameraError) as caught:
            pair.driver.picture(2.0)
        said = everything_said(caught.value)
        said += repr(pair.driver) + str(pair.driver) + repr(pair.driver.health) + repr(pair.driver._exchange)
    said += caplog.text
    for secret in (PASSWORD, base64.b64encode(f"operator:{PASSWORD}".encode()).decode(), "Authorization"):
        assert secret not in said
