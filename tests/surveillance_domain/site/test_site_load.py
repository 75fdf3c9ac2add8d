"""Loading sites: built-in ones, whole files, and everything that can be wrong between the fields."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import builtin_sites, load_site

HEAD = """
schema_version = 1
[map]
cell_m = 1.0
rows = ["..#.", "...."]
"""
CAMERA = """
[[cameras]]
name = "a"
mount = { position_m = [0, 0, 2.5], yaw_deg = 45 }
zoom_hfov = [[1, 48.0], [9999, 2.7]]
image = { width = 704, height = 576 }
max_depth_m = 8
presets = [{ name = "left", pan = -30, tilt = -40, zoom = 1 }]
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "site.toml"
    file.write_text(text, encoding="utf-8")
    return file


def faults(folder: Path, text: str) -> list[tuple[str, str]]:
    with pytest.raises(SiteError) as caught:
        load_site(written(folder, text))
    return [(fault.where, f"{fault.found} | {fault.expected}") for fault in caught.value.faults]


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "cells", "cameras", "presets", "directions"),
    [
        ("micro", 4, 2, 2, 4),
        ("tiny", 20, 2, 3, 8),
        ("tiny-3", 9, 2, 3, 4),
        ("hall", 200, 4, 3, 8),
        ("corridor", 200, 4, 3, 8),
        ("junction", 168, 4, 3, 8),
        ("lego", 80, 3, 3, 8),
    ],
)
def test_built_in_sites_have_the_sizes_of_the_paper(
    name: str, cells: int, cameras: int, presets: int, directions: int
) -> None:
    site = load_site(name)
    assert site.grid.size == cells
    assert [len(camera.presets) for camera in site.cameras] == [presets] * cameras
    assert (site.targets.directions, site.path, site.name) == (directions, None, name)
    cells_a_step = site.targets.speeds_mps[0] * site.control.step_s / site.grid.cell_m
    assert cells_a_step == pytest.approx(1.5 if name in {"hall", "corridor", "junction", "tiny"} else 1.0)


@pytest.mark.example
def test_all_built_in_sites_are_listed() -> None:
    assert builtin_sites() == ("corridor", "hall", "junction", "lego", "micro", "tiny", "tiny-3")


@pytest.mark.example
def test_rows_are_drawn_top_row_first(tmp_path: Path) -> None:
    site = load_site(written(tmp_path, HEAD + CAMERA))
    assert site.grid.free.tolist() == [[True] * 4, [True, True, False, True]]


@pytest.mark.example
def test_defaults_are_merged_key_by_key_and_a_camera_overrides_them(tmp_path: Path) -> None:
    second = CAMERA.replace('"a"', '"b"') + "settle_s = 0.7\n"
    text = HEAD + "[defaults]\nsettle_s = 0.3\ncell_noise_m = 0.2\n" + CAMERA + second
    cameras = load_site(written(tmp_path, text)).cameras
    assert [camera.settle_s for camera in cameras] == [0.3, 0.7]
    assert [camera.cell_noise_m for camera in cameras] == [0.2, 0.2]


@pytest.mark.example
def test_a_wrong_default_is_reported_once_where_it_stands(tmp_path: Path) -> None:
    text = HEAD + "[defaults]\nsettle_s = -1\n" + CAMERA + CAMERA.replace('"a"', '"b"')
    assert faults(tmp_path, text) == [("defaults.settle_s", "-1 | seconds, 0 to 3600")]
    assert [where for where, _ in faults(tmp_path, "defaults = 3\n" + HEAD + CAMERA)] == ["defaults"]


@pytest.mark.example
def test_all_faults_are_told_at_once(tmp_path: Path) -> None:
    text = HEAD.replace("cell_m = 1.0", "cell_m = nan") + CAMERA.replace("-30", '"x"').replace("max_depth_m = 8", "")
    assert [where for where, _ in faults(tmp_path, text)] == ["map.cell_m", "cameras[0].presets[0].pan"]
    text = HEAD + CAMERA.replace("[0, 0, 2.5]", "[2.5, 1.5, 2.5]").replace("max_depth_m = 8", 'home = "right"')
    found = faults(tmp_path, text)
    assert [where for where, _ in found] == ["cameras[0].home", "cameras[0]", "cameras[0].mount.position_m"]
    assert "blocked cell [2, 1]" in found[2][1]


@pytest.mark.example
@pytest.mark.parametrize(
    ("change", "where", "told"),
    [
        (("0, 0, 2.5", "2.5, 1.5, 2.5"), "cameras[0].mount.position_m", "blocked cell [2, 1]"),
        (("0, 0, 2.5", "1e6, 0, 2.5"), "cameras[0].mount.position_m", "100000 cells"),
        (('name = "left"', 'name = "left", password = "hunter2"'), "cameras[0].presets[0].password", "password_env"),
        (("max_depth_m", 'url = "http://me:hunter2@h"\nmax_depth_m'), "cameras[0].url", "password_env"),
        (("max_depth_m", 'url = "http://h/?pwd=hunter2"\nmax_depth_m'), "cameras[0].url", "password_env"),
        (("max_depth_m", 'url = "ftp://h"\nmax_depth_m'), "cameras[0].url", "http://192.168.0.90"),
        (("max_depth_m", 'url = "http://h:99999"\nmax_depth_m'), "cameras[0].url", "http://192.168.0.90"),
        (("max_depth_m", 'password = "hunter2"\nmax_depth_m'), "cameras[0].password", "password_env"),
        (("max_depth_m", 'ca_file = "x.pem"\nmax_depth_m'), "cameras[0].ca_file", "https"),
        (("max_depth_m", 'url = "https://h"\nca_file = "x.pem"\nmax_depth_m'), "cameras[0].ca_file", "not there"),
        (("max_depth_m", 'home = "middle"\nmax_depth_m'), "cameras[0].home", "left"),
        (("zoom = 1 }", "zoom = 10000 }"), "cameras[0].presets[0].zoom", "1 to 9999"),
        (("[[1, 48.0], [9999, 2.7]]", "[[1, 2.7], [9999, 48]]"), "cameras[0].zoom_hfov", "falling"),
        (("[[1, 48.0], [9999, 2.7]]", "[[9999, 48], [1, 2.7]]"), "cameras[0].zoom_hfov", "rising"),
        (("max_depth_m = 8", ""), "cameras[0]", "required_px_per_m"),
        (
            ("zoom = 1 }]", 'zoom = 1 }, { name = "left", pan = 0, tilt = -40, zoom = 1 }]'),
            "cameras[0].presets[0] and cameras[0].presets[1]",
            "2 times",
        ),
        (
            ("zoom = 1 }", "zoom = 1, homography = [[1, 0, 0], [2, 0, 0], [0, 0, 1]] }"),
            "cameras[0].presets[0].homography",
            "singular",
        ),
        (('rows = ["..#.", "...."]', 'rows = ["####"]'), "map.rows", "without free cells"),
        (('rows = ["..#.", "...."]', 'rows = ["..", "..."]'), "map.rows[1]", "3 marks"),
        (('rows = ["..#.", "...."]', 'rows = ["..x"]'), "map.rows[0]", '"x"'),
        (('rows = ["..#.", "...."]', 'rows = [""]'), "map.rows[0]", "empty"),
        (('rows = ["..#.", "...."]', ""), "map", "neither"),
        (('rows = ["..#.", "...."]', 'rows = ["."]\nros = "m.yaml"'), "map", "both"),
        (("schema_version = 1", "schema_version = 2"), "schema_version", "1"),
    ],
)
def test_what_is_wrong_among_fields_is_told_without_secrets(
    tmp_path: Path, change: tuple[str, str], where: str, told: str
) -> None:
    text = HEAD + CAMERA
    assert change[0] in text
    found = faults(tmp_path, text.replace(*change))
    assert [place for place, _ in found] == [where]
    assert told in found[0][1]
    assert "hunter2" not in str(found)


@pytest.mark.example
@pytest.mark.parametrize(
    ("tables", "where"),
    [
        ("[[targets.doors]]\ncells = [[2, 1]]\nrate_per_s = 0.1", "targets.doors[0].cells[0]"),
        ("[[targets.doors]]\ncells = [[0, 0], [4, 0]]\nrate_per_s = 0.1", "targets.doors[0].cells[1]"),
        ("[[targets.doors]]\ncells = [[0, 0], [0, 0]]\nrate_per_s = 0.1", "targets.doors"),
        ("[targets]\nspeeds_mps = [1.0, 1.0]", "targets.speeds_mps"),
        ("[targets]\nknown = [{ name = 'a' }, { name = 'a' }]", "targets.known[0] and targets.known[1]"),
        (
            "[targets]\nknown = [{ name = 'a', marker = 1 }, { name = 'b', marker = 1 }]",
            "targets.known[0] and targets.known[1]",
        ),
        ("[markers]\nside_m = 0.1\n[targets]\nknown = [{ name = 'a', marker = 50 }]", "targets.known[0].marker"),
        ("[[privacy]]\npolygon_m = [[0, 0], [1, 1], [2, 2]]", "privacy[0].polygon_m"),
        (
            "[[static_cameras]]\nname = 's'\nposition_m = [2.5, 1.5, 3]\nnoise_m = [0, 0]",
            "static_cameras[0].position_m",
        ),
    ],
)
def test_doors_targets_areas_and_static_cameras_are_checked(tmp_path: Path, tables: str, where: str) -> None:
    assert [place for place, _ in faults(tmp_path, HEAD + CAMERA + tables + "\n")] == [where]


@pytest.mark.example
@pytest.mark.parametrize("position", ["2, 1.5", "2.5, 1", "2, 1", "-3, 5", "2.5, 2"])
def test_a_camera_may_hang_on_the_edge_of_a_wall_or_outside(tmp_path: Path, position: str) -> None:
    assert load_site(written(tmp_path, HEAD + CAMERA.replace("0, 0, 2.5", f"{position}, 2.5"))).grid.size == 7


@pytest.mark.example
def test_the_edge_between_two_blocked_cells_is_inside_a_wall(tmp_path: Path) -> None:
    text = HEAD.replace("..#.", ".##.") + CAMERA.replace("0, 0, 2.5", "2, 1.5, 2.5")
    assert [where for where, _ in faults(tmp_path, text)] == ["cameras[0].mount.position_m"]


@pytest.mark.example
def test_a_file_that_is_not_toml_is_told_with_its_line(tmp_path: Path) -> None:
    assert "line 3" in faults(tmp_path, "a = 1\nb = 2\nc = = 3\n")[0][1]
    file = tmp_path / "latin.toml"
    file.write_bytes(b"schema_version = 1\nname = '\xe9'\n")
    with pytest.raises(SiteError, match="line 2: found bytes that are not UTF-8"):
        load_site(file)


@pytest.mark.example
def test_a_site_that_is_not_there_names_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(SiteError, match=r"no such file.*hall.*did you mean corridor\?"):
        load_site("coridor")
    with pytest.raises(SiteError, match="is a directory"):
        load_site(tmp_path)


@pytest.mark.example
def test_the_digest_follows_the_file(tmp_path: Path) -> None:
    first = load_site(written(tmp_path, HEAD + CAMERA)).digest
    assert load_site(written(tmp_path, HEAD + CAMERA)).digest == first
    assert load_site(written(tmp_path, HEAD + CAMERA + "# \n")).digest != first


@pytest.mark.example
def test_overrides_reach_all_cameras_and_are_checked() -> None:
    site = load_site("tiny")
    changed = site.with_overrides(detection_probability=0.8)
    assert [camera.detection_probability for camera in changed.cameras] == [0.8, 0.8]
    assert [camera.cell_noise_m for camera in changed.cameras] == [0.0, 0.0]
    assert [camera.detection_probability for camera in site.cameras] == [1.0, 1.0]
    with pytest.raises(SiteError, match=r"detection_probability: found 1\.5; expected a probability, 0 to 1"):
        site.with_overrides(detection_probability=1.5)
    with pytest.raises(SiteError, match="cell_noise_m: found nan"):
        site.with_overrides(cell_noise_m=float("nan"))


@pytest.mark.example
def test_the_junction_is_two_streets_with_a_pillar() -> None:
    free = load_site("junction").grid.free
    assert np.array_equal(free, free[::-1])
    assert np.array_equal(free, free[:, ::-1])
    assert not free[7:9, 10:12].any()
