"""A site file that is changed keeps all the rest, and is never left broken."""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import replace
from importlib import resources
from pathlib import Path

import pytest

from surveillance_domain.site.editing import add_preset, editable_path, edited_site, set_camera_key, set_homography
from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site

FLAT = [[0.01, 0.0, 1.0], [0.0, -0.01, 2.5], [0.0, 0.0, 1.0]]
OWN_TABLES = """# two cameras
schema_version = 1

[map]
rows = ["....", "...."]  # drawn
cell_m = 0.5

[[cameras]]
name = "north"   # the first
zoom_hfov = [[1, 48.0], [9999, 2.7]]
image = { width = 704, height = 576 }
max_depth_m = 4.0
[cameras.mount]
position_m = [1.0, 1.2, 2.0]
yaw_deg = -90
[[cameras.presets]]
name = "left"  # to the door
pan = -20.0
tilt = -30.0
zoom = 1
[[cameras.presets]]
name = "right"
pan = 20.0
tilt = -30.0
zoom = 1

[[cameras]]
name = "south"
mount = { position_m = [1.0, -0.2, 2.0], yaw_deg = 90 }
zoom_hfov = [[1, 48.0], [9999, 2.7]]
image = { width = 704, height = 576 }
max_depth_m = 4.0
presets = [{ name = "only", pan = 0, tilt = -30, zoom = 1 }]

[control]
step_s = 2.0  # slow
"""


@pytest.fixture
def lego(tmp_path: Path) -> Path:
    path = tmp_path / "site.toml"
    path.write_bytes((resources.files("surveillance_domain.site") / "builtin" / "lego.toml").read_bytes())
    return path


@pytest.fixture
def own_tables(tmp_path: Path) -> Path:
    path = tmp_path / "site.toml"
    path.write_text(OWN_TABLES, encoding="utf-8")
    return path


def lines_gone(before: str, after: str) -> list[str]:
    """Lines of the old file that the new one does not have."""
    return [line[2:] for line in difflib.ndiff(before.splitlines(), after.splitlines()) if line.startswith("- ")]


@pytest.mark.example
def test_defaults_become_the_cameras_own_and_stay_the_others(lego: Path) -> None:
    before, old = lego.read_text(encoding="utf-8"), load_site(lego)
    with edited_site(lego) as document:
        set_homography(document, "south", "left", FLAT)
    new = load_site(lego)
    assert new.cameras[0].presets[0].homography == tuple(map(tuple, FLAT))
    assert new.cameras[0].presets[1:] == old.cameras[0].presets[1:]
    assert new.cameras[1:] == old.cameras[1:]
    assert replace(new, cameras=old.cameras, digest=old.digest, grid=old.grid) == old
    assert lines_gone(before, lego.read_text(encoding="utf-8")) == []


@pytest.mark.example
@pytest.mark.parametrize(("camera", "preset"), [("north", "right"), ("south", "only")])
def test_presets_of_either_form(own_tables: Path, camera: str, preset: str) -> None:
    before = tomllib.loads(OWN_TABLES)
    with edited_site(own_tables) as document:
        set_homography(document, camera, preset, FLAT)
        add_preset(document, camera, {"name": "new", "pan": 1.5, "tilt": -25.0, "zoom": 7.0})
        set_camera_key(document, camera, "mount", {"yaw_deg": 12.5, "roll_deg": 1.0})
        set_camera_key(document, camera, "zoom_hfov", [[1, 47.0], [9999, 2.6]])
    after = tomllib.loads(own_tables.read_text(encoding="utf-8"))
    (one,) = [table for table in before["cameras"] if table["name"] == camera]
    (target,) = [table for table in one["presets"] if table["name"] == preset]
    target["homography"] = FLAT
    one["presets"].append({"name": "new", "pan": 1.5, "tilt": -25.0, "zoom": 7.0})
    one["mount"] |= {"yaw_deg": 12.5, "roll_deg": 1.0}
    one["zoom_hfov"] = [[1, 47.0], [9999, 2.6]]
    assert after == before
    text = own_tables.read_text(encoding="utf-8")
    for comment in ("# two cameras", "# drawn", "# the first", "# to the door", "# slow"):
        assert comment in text


@pytest.mark.example
def test_a_table_of_the_defaults_is_the_cameras_own_once_changed(lego: Path) -> None:
    with edited_site(lego) as document:
        set_camera_key(document, "south", "image", {"width": 352, "height": 288})
    assert [camera.image.width for camera in load_site(lego).cameras] == [352, 704, 704]


@pytest.mark.example
def test_a_key_that_was_not_there(own_tables: Path) -> None:
    with edited_site(own_tables) as document:
        set_camera_key(document, "north", "cell_noise_m", 0.1)
    assert [camera.cell_noise_m for camera in load_site(own_tables).cameras] == [0.1, 0.0]


@pytest.mark.example
def test_a_homography_is_replaced_and_taken_away(own_tables: Path) -> None:
    for homography in (FLAT, [[0.02, 0.0, 1.0], *FLAT[1:]]):
        with edited_site(own_tables) as document:
            set_homography(document, "north", "left", homography)
        assert load_site(own_tables).cameras[0].presets[0].homography == tuple(map(tuple, homography))
    with edited_site(own_tables) as document:
        set_homography(document, "north", "left", None)
    assert own_tables.read_text(encoding="utf-8") == OWN_TABLES


@pytest.mark.example
def test_a_change_that_would_break_the_site_is_not_written(own_tables: Path) -> None:
    with pytest.raises(SiteError, match="as it would be changed") as caught, edited_site(own_tables) as document:
        add_preset(document, "south", {"name": "only", "pan": 500.0, "tilt": 0.0, "zoom": 1})
    assert "cameras[1].presets[1].pan" in str(caught.value)
    assert own_tables.read_text(encoding="utf-8") == OWN_TABLES
    assert [path.name for path in own_tables.parent.iterdir()] == ["site.toml"]


@pytest.mark.example
def test_an_error_in_between_leaves_the_file(own_tables: Path) -> None:
    def change() -> None:
        with edited_site(own_tables) as document:
            set_camera_key(document, "north", "max_depth_m", 3.0)
            set_camera_key(document, "west", "max_depth_m", 3.0)

    with pytest.raises(KeyError):
        change()
    assert own_tables.read_text(encoding="utf-8") == OWN_TABLES


@pytest.mark.example
def test_permissions_and_line_ends_stay(own_tables: Path) -> None:
    own_tables.write_bytes(OWN_TABLES.replace("\n", "\r\n").encode())
    own_tables.chmod(0o640)
    with edited_site(own_tables) as document:
        set_camera_key(document, "north", "max_depth_m", 3.0)
    assert own_tables.stat().st_mode & 0o777 == 0o640
    assert (
        own_tables.read_bytes()
        == OWN_TABLES.replace("max_depth_m = 4.0", "max_depth_m = 3.0", 1).replace("\n", "\r\n").encode()
    )


@pytest.mark.example
def test_built_in_sites_are_not_changed(own_tables: Path) -> None:
    with pytest.raises(SiteError, match="built-in"):
        editable_path(load_site("lego"))
    assert editable_path(load_site(own_tables)) == own_tables


@pytest.mark.example
def test_a_link_stays_a_link_and_its_file_is_changed(own_tables: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    link = elsewhere / "link.toml"
    link.symlink_to(own_tables)
    with edited_site(link) as document:
        document["control"]["step_s"] = 4.0
    assert link.is_symlink()
    assert "step_s = 4.0  # slow" in own_tables.read_text(encoding="utf-8")
    assert sorted(path.name for path in elsewhere.iterdir()) == ["link.toml"]
    site = load_site(link)
    assert (site.name, site.path, site.control.step_s) == ("link", own_tables, 4.0)
