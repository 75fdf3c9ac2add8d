"""``surveillance emulate``."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import requests
from requests.auth import HTTPDigestAuth

pytest.importorskip("cv2")

from surveillance_domain.site.load import load_site


@pytest.mark.end_to_end
def test_it_serves_until_it_is_told_to_stop() -> None:
    command = [sys.executable, "-c", "from surveillance_domain.commands import main; main()"]
    process = subprocess.Popen(
        [*command, "emulate", "lego", "--targets", "2", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line)
            if line.rstrip() == b"}":
                break
        found = json.loads(b"".join(lines))
        assert [camera["name"] for camera in found["cameras"]] == ["south", "north-west", "north-east"]
        with requests.Session() as session:
            session.trust_env = False
            session.auth = HTTPDigestAuth(found["username"], found["password"])
            for camera in found["cameras"]:
                picture = session.get(f"{camera['url']}/axis-cgi/jpg/image.cgi", timeout=30)
                assert picture.content.startswith(b"\xff\xd8\xff")
        os.kill(process.pid, signal.SIGINT)
        _, err = process.communicate(timeout=30)
        assert process.returncode == 0
        assert err.decode().strip() == "Ctrl-C ends them."
    finally:
        process.kill()
        process.communicate()


@pytest.mark.end_to_end
def test_a_table_for_people_and_an_end_of_its_own(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("emulate", "tiny", "--seconds", "0.05")
    assert answer.code == 0
    assert answer.out.count("http://127.0.0.1:") == 4
    assert "User operator, password emulated." in answer.out


@pytest.mark.end_to_end
def test_a_port_that_is_taken(surveillance: Callable[..., Any]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        answer = surveillance("emulate", "tiny", "--port", port, "--seconds", "0.05")
    assert answer.code == 2
    assert f"--port {port}: address already in use" in answer.err


@pytest.mark.end_to_end
def test_a_site_that_is_not_there(surveillance: Callable[..., Any]) -> None:
    answer = surveillance("emulate", "lega", "--seconds", "0.05")
    assert answer.code == 2
    assert "did you mean lego" in answer.err


@pytest.mark.end_to_end
def test_markers_on_the_floor(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    markers = tmp_path / "markers.csv"
    markers.write_text("marker,x_m,y_m\n60,1.0,1.0\n")
    wrong = surveillance("emulate", "lego", "--floor-markers", markers, "--seconds", "0.05")
    assert (wrong.code, "marker 60: the dictionary 4X4_50 has 0 to 49" in wrong.err) == (2, True)
    wrong = surveillance("emulate", "hall", "--floor-markers", markers, "--seconds", "0.05")
    assert (wrong.code, "needs a [markers] table" in wrong.err) == (2, True)
    markers.write_text("marker,x_m,y_m\n40,1.0,1.0\n")
    assert surveillance("emulate", "lego", "--floor-markers", markers, "--seconds", "0.05").code == 0


@pytest.mark.end_to_end
def test_a_site_file_that_leads_to_them(surveillance: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "desk.toml"
    words = ("emulate", "lego", "--seconds", "0.05", "--site-out", path)
    answer = surveillance(*words)
    assert answer.code == 0, answer.err
    assert f"Written: {path}. First: export CAM_PASSWORD=emulated" in answer.err
    found = load_site(path)
    assert [(c.name, c.username, c.password_env) for c in found.cameras] == [
        (name, "operator", "CAM_PASSWORD") for name in ("south", "north-west", "north-east")
    ]
    assert all(camera.url in answer.out for camera in found.cameras if camera.url)
    assert "# The paper's real experiment" in path.read_text(encoding="utf-8")
    again = surveillance(*words)
    assert (again.code, f"{path} is there already" in again.err) == (2, True)
    assert again.out == ""  # found before anything was started
    nowhere = surveillance(*words[:-1], tmp_path / "none" / "desk.toml")
    assert (nowhere.code, "there is no folder" in nowhere.err, nowhere.out) == (2, True, "")
    assert [file.name for file in tmp_path.iterdir()] == ["desk.toml"]


@pytest.mark.end_to_end
def test_faults_on_demand(surveillance: Callable[..., Any]) -> None:
    words = ("--fault", "south:joystick@0-0.2", "--fault", "north-west:latency_s=0.1@0.1")
    answer = surveillance("emulate", "lego", *words, "--seconds", "0.6")
    assert answer.code == 0, answer.err
    assert answer.err.splitlines() == [
        "0 s: south: joystick=10 begins",
        "0.1 s: north-west: latency_s=0.1 begins",
        "0.2 s: south: joystick=10 ends",
    ]
    wrong = surveillance("emulate", "lego", "--fault", "south:latency=2", "--seconds", "0.05")
    assert (wrong.code, wrong.out) == (2, "")
    assert "--fault south:latency=2: no kind of fault 'latency' (did you mean 'latency_s'?)" in wrong.err
