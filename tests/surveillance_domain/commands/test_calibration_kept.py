"""From calibrate to doctor at the command line: its points are kept beside the site, and looked for again."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.emulation.site import PASSWORD, USERNAME, EmulatedSite
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.point_files import read_markers

MARKERS = """marker,x_m,y_m
30,0.9,1.0
31,2.1,1.0
32,1.0,1.9
33,2.0,1.9
34,1.5,1.4
"""


@pytest.mark.end_to_end
def test_calibrate_keeps_what_the_doctor_looks_for(
    surveillance: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("CAM_PASSWORD", PASSWORD)
    text = (resources.files("surveillance_domain.site") / "builtin" / "lego.toml").read_text(encoding="utf-8")
    text = text.partition('[[cameras]]\nname = "north-west"')[0] + text[text.index("[[static_cameras]]") :]
    text = text.replace("deg_per_s = 100", "deg_per_s = 2000").replace("deg_per_s = 90", "deg_per_s = 2000")
    text = text.replace("settle_s = 0.3", f'settle_s = 0.1\nusername = "{USERNAME}"\npassword_env = "CAM_PASSWORD"')
    site, markers = tmp_path / "site.toml", tmp_path / "markers.csv"
    site.write_text(text, encoding="utf-8")
    markers.write_text(MARKERS, encoding="utf-8")
    laid = tuple(read_markers(markers).values())
    with EmulatedSite(load_site(site), 1, RealClock(), np.random.default_rng(0), laid=laid) as emulation:
        url = emulation.servers["south"].url
        site.write_text(text.replace('name = "south"', f'name = "south"\nurl = "{url}"'), encoding="utf-8")
        words = ["calibrate", site, "south", "--floor-markers", markers, "--live", "--mount", "--write", "--json"]
        answer = surveillance(*words)
        assert answer.code == 0, answer.err
        kept = json.loads((tmp_path / "site.calibration.json").read_text(encoding="utf-8"))
        presets = {one["name"]: one["points"] for one in kept["cameras"][0]["presets"]}
        assert {point["marker"] for point in presets["middle"]} == {30, 31, 32, 33, 34}
        assert sum(map(len, presets.values())) == answer.json["fitting"]
        before = site.read_bytes()
        found = surveillance("doctor", site, "--json")
        assert found.code == 0, found.out
        (check,) = [one for one in found.json["cameras"][0]["checks"] if one["name"] == "calibration points"]
        assert "points found again at" in check["detail"]
        emulation.cameras["south"].faults.pan_slip_deg = -8.0
        found = surveillance("doctor", site, "--json")
        assert found.code == 1
        wrong = [one["name"] for one in found.json["cameras"][0]["checks"] if not one["ok"]]
        assert wrong == ["calibration points"]
        assert site.read_bytes() == before
    (tmp_path / "site.calibration.json").write_text("{}", encoding="utf-8")
    wrong = surveillance("doctor", site)
    assert (wrong.code, "site.calibration.json" in wrong.err) == (2, True)
