"""``surveillance calibrate``, from clicked points and from markers in pictures; and ``add-preset``."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveillance_domain.cameras.base import Position
from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.emulation.camera import EmulatedCamera
from surveillance_domain.emulation.guard import Guard
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.server import CameraServer
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.model.views import build_views
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.vision.agreement import disagreement_m
from surveillance_domain.vision.opencv import read_image
from surveillance_domain.world.memory import Stood
from tests.emulated_cameras import LIMITS
from tests.known_points import lego_camera, points_of
from tests.pictured_targets import LAID_M, jpeg_of, laid, preset_view

Command = Callable[..., Any]

MIDDLE = ((0.9, 1.0), (2.1, 1.0), (1.0, 1.9), (2.0, 1.9), (1.5, 1.4))
LEFT = ((0.7, 0.7), (1.0, 1.0), (0.4, 1.2), (0.8, 1.5), (0.6, 1.0))
TRUTH = lego_camera(yaw_deg=94.0, pitch_deg=-1.5)
"""How the southern camera really hangs; the site says 90 and 0."""


@pytest.fixture
def lego(tmp_path: Path) -> Path:
    path = tmp_path / "lego.toml"
    path.write_bytes((resources.files("surveillance_domain.site") / "builtin" / "lego.toml").read_bytes())
    return path


def clicked(folder: Path, *presets: tuple[str, tuple[tuple[float, float], ...]], noise_px: float = 0.3) -> Path:
    rows = ["preset,u,v,x_m,y_m"]
    for preset, places in presets:
        for point in points_of(TRUTH, preset, places, noise_px=noise_px):
            rows.append(",".join(map(str, (preset, *point.pixel, *point.place_m))))
    path = folder / "points.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def marker_table(folder: Path, places: tuple[tuple[float, float], ...]) -> Path:
    path = folder / "markers.csv"
    rows = [f"{number},{x},{y},{LAID_M}" for number, (x, y) in enumerate(places)]
    path.write_text("\n".join(["marker,x_m,y_m,height_m", *rows]), encoding="utf-8")
    return path


def preset_of(path: Path, camera: int, preset: int) -> tuple[Camera, Any]:
    described = load_site(path).cameras[camera]
    return described, described.presets[preset]


@pytest.mark.end_to_end
def test_homographies_from_clicked_points(surveillance: Command, lego: Path, tmp_path: Path) -> None:
    before = tomllib.loads(lego.read_text(encoding="utf-8"))
    points = clicked(tmp_path, ("middle", MIDDLE), ("left", LEFT))
    answer = surveillance("calibrate", lego, "south", "--points", points, "--write", "--json")
    assert answer.code == 0, answer.err
    found = answer.json
    assert found["method"] == "homography"
    assert [(one["name"], one["points"], one["checked"]) for one in found["presets"]] == [
        ("left", 5, True),
        ("middle", 5, True),
    ]
    assert all(one["residual_px"] < 1 and one["residual_m"] < 0.01 for one in found["presets"])
    assert found["written"] == str(lego)
    # The site says another mount than the camera has; so homography and mount disagree, by about 4 degrees of 1.7 m.
    assert 0.05 < disagreement_m(*preset_of(lego, 0, 1), np.array(MIDDLE)) < 0.3
    after = tomllib.loads(lego.read_text(encoding="utf-8"))
    assert [preset.pop("homography", None) is not None for preset in after["cameras"][0].pop("presets")] == [
        True,
        True,
        False,
    ]
    assert after == before


@pytest.mark.end_to_end
def test_a_mount_from_markers_in_pictures_serves_all_presets(surveillance: Command, lego: Path, tmp_path: Path) -> None:
    site, places = laid(load_site(lego)), (*MIDDLE[:4], *LEFT[:4])
    pictures = []
    for preset in ("middle", "left"):
        (tmp_path / f"{preset}.jpg").write_bytes(jpeg_of(site, preset_view(TRUTH, preset), places, range(8)))
        pictures += ["--picture", f"{preset}={tmp_path / preset}.jpg"]
    markers, out = marker_table(tmp_path, places), tmp_path / "grids"
    words = ["--floor-markers", markers, *pictures, "--mount", "--out", out, "--write"]
    answer = surveillance("calibrate", lego, "south", *words, "--json")
    assert answer.code == 0, answer.err
    found = answer.json
    assert found["method"] == "mount"
    assert found["mount"]["yaw_deg"] == pytest.approx(94, abs=0.2)
    assert found["mount"]["pitch_deg"] == pytest.approx(-1.5, abs=0.2)
    assert found["focal_scale"] == pytest.approx(1, abs=0.01)
    assert found["residual_px"] < 1 < 20 < found["residual_px_before"]
    assert all(point["fits"] for point in found["points"])
    written = load_site(lego).cameras[0]
    right = preset_view(written, "right").on_plane(np.array([[351.5, 287.5]]))
    np.testing.assert_allclose(right, preset_view(TRUTH, "right").on_plane(np.array([[351.5, 287.5]])), atol=0.03)
    assert sorted(path.name for path in out.iterdir()) == ["south-left.png", "south-middle.png"]
    plain, drawn = read_image(tmp_path / "middle.jpg"), read_image(out / "south-middle.png")
    assert drawn.shape == plain.shape
    assert 0.02 < np.mean((drawn != plain).any(axis=2)) < 0.3  # lines, not a flood


@pytest.mark.end_to_end
def test_points_that_do_not_fit_are_named(surveillance: Command, lego: Path, tmp_path: Path) -> None:
    places = (*MIDDLE, (1.2, 1.2), (1.8, 1.7), (1.3, 1.7))
    points = clicked(tmp_path, ("middle", places))
    points.write_text(points.read_text(encoding="utf-8").replace(",1.8,1.7", ",1.7,1.8"), encoding="utf-8")
    answer = surveillance("calibrate", lego, "south", "--points", points)
    assert answer.code == 0
    assert [line.split()[0:3] for line in answer.out.splitlines() if "does not fit" in line] == [
        ["line", "8", "middle"]
    ]
    assert "7 of 8 points" in answer.out


@pytest.mark.end_to_end
def test_a_preset_without_a_fit_is_named_and_the_others_are_kept(
    surveillance: Command, lego: Path, tmp_path: Path
) -> None:
    line = ((0.4, 0.6), (0.6, 0.9), (0.8, 1.2), (0.5, 1.3))
    points = clicked(tmp_path, ("left", line), ("middle", MIDDLE), noise_px=0.0)
    words = ["calibrate", lego, "south", "--points", points]
    answer = surveillance(*words, "--write", "--json")
    assert answer.code == 1
    assert [(one["name"], one["fits"]) for one in answer.json["presets"]] == [("middle", True)]
    (refused,) = answer.json["refused"]
    assert refused["preset"] == "left"
    assert "line 2, line 3, line 4 lie on one line" in refused["because"]
    assert (answer.json["fits"], answer.json["written"]) == (False, str(lego))
    presets = load_site(lego).cameras[0].presets
    assert [preset.homography is not None for preset in presets] == [False, True, False]
    kept = json.loads((tmp_path / "lego.calibration.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in kept["cameras"][0]["presets"]] == ["middle"]
    told = surveillance(*words, "--write")
    assert told.code == 1
    for part in ('Not calibrated: preset "left"', "--mount", f"Written: {lego}, of the presets that fit: middle"):
        assert part in " ".join(told.out.split())


@pytest.mark.end_to_end
def test_a_preset_whose_points_disagree_is_not_written_and_the_others_are(
    surveillance: Command, lego: Path, tmp_path: Path
) -> None:
    points = clicked(tmp_path, ("middle", MIDDLE), noise_px=0.0)
    spread = np.random.default_rng(0).uniform((0, 0, 0.2, 0.5), (700, 570, 1.2, 1.6), (12, 4)).tolist()
    rows = [f"left,{','.join(map(str, row))}\n" for row in spread]
    points.write_text(points.read_text(encoding="utf-8") + "".join(rows), encoding="utf-8")
    answer = surveillance("calibrate", lego, "south", "--points", points, "--write", "--json")
    assert (answer.code, [one["name"] for one in answer.json["presets"]]) == (1, ["middle"])
    assert "of 12 points agree with one another" in answer.json["refused"][0]["because"]
    assert [preset.homography is not None for preset in load_site(lego).cameras[0].presets] == [False, True, False]


@pytest.mark.end_to_end
def test_a_mount_by_which_a_preset_sees_nothing_is_not_written(
    surveillance: Command, lego: Path, tmp_path: Path
) -> None:
    text = lego.read_text(encoding="utf-8").replace('{ name = "left", pan = -40.0', '{ name = "left", pan = -100.0', 1)
    lego.write_text(text, encoding="utf-8")
    with pytest.raises(SiteError):  # the other cameras' left presets look away; only the southern one is spoken of here
        build_views(load_site(lego))
    rest = text.index('[[cameras]]\nname = "north-west"')
    text = text[:rest] + text[text.index("[[static_cameras]]") :]
    lego.write_text(text, encoding="utf-8")
    build_views(load_site(lego))  # by the site's own mount it still sees some of the floor
    answer = surveillance(
        "calibrate", lego, "south", "--points", clicked(tmp_path, ("middle", MIDDLE)), "--mount", "--write"
    )
    assert answer.code == 2
    assert f"{lego}, as it would be changed" in answer.err
    assert 'preset "left" of camera "south" that sees no free cell' in answer.err
    assert lego.read_text(encoding="utf-8") == text
    assert not (tmp_path / "lego.calibration.json").exists()


@pytest.mark.end_to_end
def test_a_calibration_that_fits_nothing_is_not_written(surveillance: Command, lego: Path, tmp_path: Path) -> None:
    rows = ["preset,u,v,x_m,y_m"]
    spread = np.random.default_rng(0).uniform((0, 0, 0, 0), (700, 570, 3, 2.4), (12, 4))
    rows += [f"{('left', 'middle')[n % 2]},{','.join(map(str, row))}" for n, row in enumerate(spread.tolist())]
    (tmp_path / "points.csv").write_text("\n".join(rows), encoding="utf-8")
    before = lego.read_bytes()
    words = ["--points", tmp_path / "points.csv", "--mount", "--write"]
    answer = surveillance("calibrate", lego, "south", *words, "--json")
    assert answer.code == 1
    assert answer.json["written"] is None
    assert answer.json["fits"] is False
    assert lego.read_bytes() == before


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["south"], "nothing to calibrate from"),
        (["soth", "--points", "POINTS"], "did you mean 'south'"),
        (["south", "--points", "none.csv"], "none.csv: found no such file"),
        (["south", "--points", "POINTS", "--picture", "up=a.jpg"], "no preset 'up'"),
        (["south", "--points", "POINTS", "--picture", "left"], "expected PRESET=FILE"),
        (["south", "--points", "POINTS", "--picture", "left=POINTS"], "expected a JPEG or PNG"),
        (["south", "--floor-markers", "POINTS"], "no pictures to look for them in"),
        (["south", "--points", "POINTS"], 'preset "left": 1 points; a homography takes at least 4'),
        (["south", "--points", "POINTS", "--mount"], "better 6 over several presets"),
        (["south", "--points", "POINTS", "--live"], "no url"),
    ],
)
def test_bad_input(
    surveillance: Command,
    lego: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    said: str,
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    points = tmp_path / "points.csv"
    points.write_text("preset,u,v,x_m,y_m\nleft,1,2,3,4\n", encoding="utf-8")
    answer = surveillance("calibrate", lego, *[word.replace("POINTS", str(points)) for word in words])
    assert answer.code == 2
    assert said in answer.err
    assert answer.out == ""


@pytest.mark.end_to_end
def test_pictures_of_another_shape_are_refused(surveillance: Command, lego: Path, tmp_path: Path) -> None:
    square = lego_camera().model_copy(update={"image": TRUTH.image.model_copy(update={"width": 576})})
    (tmp_path / "a.jpg").write_bytes(jpeg_of(load_site(lego), preset_view(square, "left"), []))
    points = clicked(tmp_path, ("left", LEFT))
    answer = surveillance("calibrate", lego, "south", "--points", points, "--picture", f"left={tmp_path / 'a.jpg'}")
    assert answer.code == 2
    assert "576 x 576 pixels; the site says 704 x 576" in answer.err


@pytest.mark.end_to_end
def test_built_in_sites_are_not_written(surveillance: Command, tmp_path: Path) -> None:
    answer = surveillance("calibrate", "lego", "south", "--points", clicked(tmp_path, ("left", LEFT)), "--write")
    assert answer.code == 2
    assert "built-in site" in answer.err


@contextmanager
def served(site: Site, places: tuple[tuple[float, float], ...]) -> Iterator[CameraServer]:
    """The southern camera of the lego site, hanging as in `TRUTH`, that looks to the left of its left preset."""
    clock, rng = RealClock(), np.random.default_rng(0)
    motors = EmulatedMotors((-50.0, -35.0, 1.0), LIMITS, (2000.0, 2000.0, np.inf), clock)
    guard = Guard("AXIS_ACCC8E000001", "operator", "secret", clock, rng)

    def snapshot(size: tuple[int, int], compression: int) -> bytes:
        return jpeg_of(site, pinhole(TRUTH, *motors.true(), size), places, range(len(places)))

    server = CameraServer(EmulatedCamera(motors, guard, snapshot, (704, 576), (), clock, rng))
    try:
        yield server
    finally:
        server.close()


def with_address(path: Path, url: str) -> None:
    text = path.read_text(encoding="utf-8")
    own = f'name = "south"\nurl = "{url}"\nusername = "operator"\npassword_env = "CAM_SOUTH"\n'
    path.write_text(text.replace('name = "south"\n', own), encoding="utf-8")


@pytest.mark.end_to_end
def test_a_camera_is_turned_from_preset_to_preset_and_back(
    surveillance: Command, lego: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CAM_SOUTH", "secret")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    places = (*MIDDLE[:4], *LEFT[:4])
    with served(laid(load_site(lego)), places) as server:
        with_address(lego, server.url)
        words = ["--floor-markers", marker_table(tmp_path, places), "--live", "--mount", "--json"]
        answer = surveillance("calibrate", lego, "south", *words)
        assert answer.code == 0, answer.err
        assert answer.json["mount"]["yaw_deg"] == pytest.approx(94, abs=0.2)
        memory = WatchState(load_site(lego)).memories()["south"]
        memory.keep(Stood(Position(-50.0, -35.0, 1.0), 20.0))
        refused = surveillance("calibrate", lego, "south", *words)
        assert refused.code == 2
        assert "camera 'south': moved by somebody else 2" in refused.err
        assert "it is not turned before it has been still for 60 s" in refused.err
        added = surveillance("add-preset", lego, "south", "door", "--json")
        assert added.code == 0, added.err
        assert added.json["preset"] == {"name": "door", "pan": -50.0, "tilt": -35.0, "zoom": 1.0}  # where it was before
        again = surveillance("add-preset", lego, "south", "door")
        assert (again.code, "already" in again.err) == (2, True)
        again = surveillance("add-preset", lego, "south", "gate")
        assert (again.code, "stands at its preset 'door'" in again.err) == (2, True)
    door = load_site(lego).cameras[0].presets[-1]
    assert (door.name, door.pan, door.tilt, door.zoom) == ("door", -50.0, -35.0, 1.0)
    assert [len(camera.presets) for camera in load_site(lego).cameras] == [4, 3, 3]


@pytest.mark.end_to_end
def test_a_camera_that_does_not_answer(surveillance: Command, lego: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CAM_SOUTH", "secret")
    with_address(lego, "http://127.0.0.1:9")
    before = lego.read_bytes()
    answer = surveillance("add-preset", lego, "south", "door")
    assert answer.code == 2
    assert "south" in answer.err
    assert "secret" not in answer.err
    assert lego.read_bytes() == before
