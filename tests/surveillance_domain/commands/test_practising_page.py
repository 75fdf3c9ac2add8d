"""The page on running cameras, followed to the letter on emulated ones: its commands as they stand there."""

from __future__ import annotations

import re
import shlex
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.emulation.rendering import Renderer
from surveillance_domain.model.looks import looks
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Markers
from surveillance_domain.site.validation import validate
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.homography import fit_homography
from surveillance_domain.vision.point_files import read_markers
from surveillance_domain.vision.points import marked_points
from tests.pictured_targets import preset_view

PAGE = Path(__file__).parents[3] / "docs" / "run-your-cameras.md"
BLOCKS = re.findall(r"```(sh|toml)\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
LINES = [line.partition("  #")[0].strip() for kind, block in BLOCKS if kind == "sh" for line in block.splitlines()]
COMMAND = [sys.executable, "-c", "from surveillance_domain.commands import main; main()"]


def words_of(beginning: str) -> list[list[str]]:
    """The words of the page's commands that begin so, without the program's name."""
    return [shlex.split(line)[1:] for line in LINES if line.startswith(f"surveillance {beginning}")]


def free_ports(count: int) -> int:
    """The first of so many ports in a row of which the first is free."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return min(int(taken.getsockname()[1]), 65_535 - count)


@pytest.fixture
def floor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the page's first commands were run: those that write markers.csv."""
    shell = shutil.which("bash")
    if shell is None:
        pytest.skip("the page's commands are for a shell")
    first = next(block for kind, block in BLOCKS if kind == "sh" and "emulate lego" in block)
    subprocess.run([shell, "-c", first.partition("surveillance ")[0]], cwd=tmp_path, check=True, timeout=30)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def desk(floor: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The same, and the emulated cameras run until the test is over."""
    monkeypatch.setenv("CAM_PASSWORD", "emulated")
    monkeypatch.setenv("XDG_STATE_HOME", str(floor / "state"))
    words = next(words for words in words_of("emulate") if "--floor-markers" in words)
    words[words.index("8090")] = str(free_ports(3))
    process = subprocess.Popen([*COMMAND, *words], cwd=floor, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        assert process.stderr is not None
        assert b"Written: site.toml" in process.stderr.readline()
        yield floor
    finally:
        process.kill()
        process.communicate()


@pytest.mark.example
def test_each_preset_sees_enough_of_the_markers_that_the_page_lays(floor: Path) -> None:
    site, laid = load_site("lego"), read_markers(floor / "markers.csv")
    renderer = Renderer(site, looks(site, 1), np.random.default_rng(0), laid=tuple(laid.values()))
    detector = MarkerDetector(site.markers or Markers(side_m=1.0))
    nobody = np.array([[np.nan, np.nan]]), np.zeros(1)
    for camera in site.cameras:
        for preset in camera.presets:
            picture = renderer.picture(preset_view(camera, preset.name), *nobody)
            points = marked_points(preset.name, detector.detect(picture), laid)
            fit = fit_homography(camera, preset.name, points)
            assert len(points) >= 9  # some are hidden where a robot stands on them
            assert (sum(one.fits for one in fit.points), fit.residual_m < 0.005) == (len(points), True)


@pytest.mark.slow
@pytest.mark.end_to_end
def test_the_cameras_are_calibrated_as_the_page_says(surveillance: Callable[..., Any], desk: Path) -> None:
    by_mount, by_homographies = (words for words in words_of("calibrate") if "--live" in words)
    assert "--mount" in by_mount
    assert "--mount" not in by_homographies
    for camera in ("north-west", "north-east"):
        answer = surveillance(*[camera if word == "north" else word for word in by_homographies], "--json")
        assert answer.code == 0, answer.out
        assert [one["fitting"] >= 6 for one in answer.json["presets"]] == [True, True, True]  # 9, but for a robot
        assert all(one["residual_m"] < 0.01 for one in answer.json["presets"])
    answer = surveillance(*["south" if word == "north" else word for word in by_mount], "--json")
    assert answer.code == 0, answer.out
    assert len(answer.json["pictures"]) == 3
    for described in load_site(desk / "site.toml").cameras:
        calibrated = [preset.homography is not None for preset in described.presets]
        assert calibrated == [described.name != "south"] * 3
    (checked,) = (words for words in words_of("doctor site.toml") if "--no-move" in words)
    found = surveillance(*checked)
    assert found.code == 0, found.out


@pytest.mark.example
def test_what_the_page_says_of_faults_is_so() -> None:
    from surveillance_domain.emulation.fault_plan import KINDS, read_plan

    practice = next(words for words in words_of("emulate") if "--fault" in words)
    given = [after for word, after in pairwise(practice) if word == "--fault"]
    assert [one.camera for one in read_plan(given, ["south", "north-west", "north-east"])] == ["south", "north-west"]
    rows = [line.split("|")[1] for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    written = [kind for row in rows for kind in re.findall(r"`([^`]+)`", row)]
    assert {one.kind for one in read_plan([f"south:{kind}" for kind in written], ["south"])} == set(KINDS)


@pytest.mark.example
def test_the_mask_on_the_page_is_a_key_of_a_camera() -> None:
    import tomllib

    (mask,) = (tomllib.loads(block) for kind, block in BLOCKS if kind == "toml" and block.startswith("privacy_masks"))
    _, faults = validate({"schema_version": 1, "map": {"cell_m": 1.0, "rows": ["."]}, "cameras": [mask]})
    assert not [fault for fault in faults if "privacy" in fault.where]
