"""The emulated camera, held to others' words: recorded answers, and a client by somebody else."""

from __future__ import annotations

from pathlib import Path

import pytest
import requests
from requests.auth import HTTPDigestAuth

from surveillance_domain.cameras import answers
from surveillance_domain.cameras.base import Limits, Position
from tests.emulated_cameras import PASSWORD, Pair, emulated_pair

SHARED = Path(__file__).parents[3] / ".." / "shared" / "data" / "camera" / "vapix.md"


def fetched(pair: Pair, path: str) -> requests.Response:
    with requests.Session() as session:
        session.trust_env = False
        return session.get(pair.server.url + path, auth=HTTPDigestAuth("operator", PASSWORD), timeout=10)


def ptz(pair: Pair, query: str) -> requests.Response:
    return fetched(pair, f"/axis-cgi/com/ptz.cgi?{query}")


@pytest.mark.end_to_end
def test_answers_have_the_form_of_recorded_ones() -> None:
    if not SHARED.is_file():
        pytest.skip("the collection of camera answers is not beside the repository")
    recorded = [answers.key_values(block) for block in SHARED.read_text(encoding="utf-8").split("```")[1::2]]
    with emulated_pair(limits=Limits((-170.0, 170.0), (-20.0, 90.0), (1.0, 9999.0))) as pair:
        limits, position = (answers.key_values(ptz(pair, f"query={what}").text) for what in ("limits", "position"))
    assert limits.keys() <= recorded[0].keys()
    assert {key: recorded[0][key] for key in limits} == limits
    assert list(position) == list(recorded[1])
    assert position["zoom"] == "1"


@pytest.mark.end_to_end
def test_words_of_the_manual() -> None:
    with emulated_pair() as pair:
        moved = ptz(pair, "pan=150&tilt=0.5&zoom=2&speed=100&camera=1")
        assert (moved.status_code, moved.content) == (204, b"")
        unknown = ptz(pair, "query=X")
        assert (unknown.status_code, unknown.text.split()) == (200, ["Error:", "query:", "unknown", "value:", "X"])
        assert ptz(pair, "query=speed").text.strip() == "speed=100"
        assert ptz(pair, "query=presetposall").text.splitlines()[1] == "presetposno1=Home"
        assert ptz(pair, "whoami=1").text.strip() == "Sony_camblock"
        assert ptz(pair, "pan=far").text.startswith("Error:")
        assert ptz(pair, "query=position&camera=3").text == "<!--Camera 3 not available.-->\n"
        assert fetched(pair, "/axis-cgi/imagesize.cgi?camera=1").text.split("\r\n")[0] == "image width = 64"
        assert fetched(pair, "/axis-cgi/param.cgi?action=list&group=Brand.Brand").text == "root.Brand.Brand=AXIS\r\n"
        assert fetched(pair, "/axis-cgi/param.cgi?action=list&group=Nothing").text.startswith("# Error:")
        assert fetched(pair, "/anything").status_code == 404
        assert fetched(pair, "/axis-cgi/jpg/image.cgi?resolution=1x").text.startswith("Error:")
        picture = fetched(pair, "/axis-cgi/jpg/image.cgi?resolution=80x60&compression=30")
        assert picture.headers["Content-Type"] == "image/jpeg"
        assert picture.content.startswith(b"\xff\xd8\xff")


@pytest.mark.end_to_end
def test_the_log_in_is_asked_as_axis_does() -> None:
    with emulated_pair() as pair, requests.Session() as session:
        session.trust_env = False
        answer = session.get(f"{pair.server.url}/axis-cgi/com/ptz.cgi?query=position", timeout=10)
        assert answer.status_code == 401
        header = answer.headers["WWW-Authenticate"]
        assert header.startswith('Digest realm="AXIS_ACCC8E000001", nonce="')
        assert header.endswith('algorithm=MD5, qop="auth"')
        assert answer.headers["Connection"] == "close"
        assert answer.headers["Content-Type"] == "text/html"


@pytest.mark.end_to_end
def test_an_answer_to_one_question_does_not_open_another() -> None:
    with emulated_pair() as pair, requests.Session() as session:
        session.trust_env = False
        first = fetched(pair, "/axis-cgi/com/ptz.cgi?query=position")
        copied = {"Authorization": first.request.headers["Authorization"]}
        same = f"{pair.server.url}/axis-cgi/com/ptz.cgi?query=position"
        other = f"{pair.server.url}/axis-cgi/com/ptz.cgi?pan=100"
        replayed = session.get(same, headers=copied, timeout=10)
        assert replayed.status_code == 401
        assert "stale=true" in replayed.headers["WWW-Authenticate"]
        assert session.get(other, headers=copied, timeout=10).status_code == 401
        assert pair.camera.motors.true() == (-20.0, -40.0, 1.0)


@pytest.mark.end_to_end
def test_an_independent_client_works() -> None:
    """vapix-python, which sends ``camera=1&html=no&timestamp=…`` with everything."""
    vapix_api = pytest.importorskip("vapix_python.VapixAPI")
    with emulated_pair() as pair:
        client = vapix_api.VapixAPI(pair.server.url.removeprefix("http://"), "operator", PASSWORD)
        client.session.trust_env = False
        try:
            assert client.ptz.get_current_position() == (-20.0, -40.0, 1.0)
            client.ptz.absolute_move(30.5, -10, 500, 100)
            pair.clock.sleep(0.25)
            assert client.ptz.get_current_position() == pytest.approx((5.0, -15.0, 500.0))
            pair.clock.sleep(5.0)
            client.ptz.relative_move(-200.5, 0, 0, 100)
            pair.clock.sleep(5.0)
            assert client.ptz.get_current_position() == (-170.0, -10.0, 500.0)
            client.ptz.go_home(100)
            pair.clock.sleep(5.0)
            assert client.ptz.get_current_position() == (0.0, 0.0, 1.0)
            assert "pan=" in client.ptz.ptz_enabled()
            assert pair.driver.position(1.0) == Position(0.0, 0.0, 1.0)
        finally:
            client.session.close()


@pytest.mark.end_to_end
def test_faults_on_demand() -> None:
    with emulated_pair() as pair:
        faults = pair.camera.faults
        faults.unavailable_share = 1.0
        assert ptz(pair, "query=position").status_code == 503
        faults.unavailable_share, faults.drop_share = 0.0, 1.0
        with pytest.raises(requests.ConnectionError):
            ptz(pair, "query=position")
        faults.drop_share, faults.wrong_password = 0.0, True
        assert ptz(pair, "query=position").status_code == 401
        faults.wrong_password, faults.latency_s = False, 3.0
        before = pair.clock.now()
        assert ptz(pair, "query=position").status_code == 200
        assert pair.clock.now() == before + 6.0  # the challenge is late as well
        faults.latency_s = 0.0
        pair.camera.reboot()
        with pytest.raises(requests.ConnectionError):
            ptz(pair, "query=position")
        pair.clock.sleep(45.0)
        assert "pan=0.0000" in ptz(pair, "query=position").text
