"""Fields of view: whole cameras against the definition cell by cell, blind presets, private areas, overrides."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from surveillance_domain.model.coverage import best_joint_coverage
from surveillance_domain.model.views import Views, build_views, static_views
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Control, Targets
from surveillance_domain.site.site import Site

EXAMPLE = Path(__file__).parents[3] / "examples" / "office" / "office.toml"
HEAD = """
schema_version = 1
[map]
cell_m = 1.0
rows = [".....", ".....", "..#..", ".....", "....."]
[[cameras]]
name = "a"
mount = { position_m = [0, 0, 2.0], yaw_deg = 45 }
zoom_hfov = [[1, 60.0]]
image = { width = 100, height = 100 }
max_depth_m = 4
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "site.toml"
    file.write_text(text, encoding="utf-8")
    return file


def in_view(grid: Grid, camera: Camera, cell: list[int], pan: float, tilt: float) -> bool:
    """The definition, for a camera without pitch and roll at zoom 1, on floor angles and sampled sight."""
    centre = [(index + 0.5) * grid.cell_m for index in cell]
    x, y, height = camera.mount.position_m
    away = math.hypot(centre[0] - x, centre[1] - y)
    heading = math.radians(camera.mount.yaw_deg - pan)
    ahead = (centre[0] - x) * math.cos(heading) + (centre[1] - y) * math.sin(heading)
    left = (centre[1] - y) * math.cos(heading) - (centre[0] - x) * math.sin(heading)
    dip = math.radians(tilt)
    forward = ahead * math.cos(dip) - height * math.sin(dip)
    up = -ahead * math.sin(dip) - height * math.cos(dip)
    half = math.tan(math.radians(camera.zoom_hfov[0][1]) / 2)
    if not (0 < forward <= camera.max_depth_m and abs(left) <= half * forward and abs(up) <= half * forward):
        return False
    steps = max(1, int(away / grid.cell_m * 100))
    for step in range(1, steps):
        share = step / steps
        column = math.floor((x + (centre[0] - x) * share) / grid.cell_m)
        row = math.floor((y + (centre[1] - y) * share) / grid.cell_m)
        if 0 <= column < grid.columns and 0 <= row < grid.rows and not grid.free[row, column]:
            return False
    return True


@pytest.mark.property
@settings(max_examples=40)
@given(
    free=arrays.arrays(np.bool_, (6, 7), elements=st.sampled_from([True, True, True, False])),
    position=st.tuples(st.floats(-0.9, 7.9), st.floats(-0.9, 6.9), st.floats(0.5, 3.0)),
    yaw=st.floats(-180, 180),
    tilt=st.floats(-70, 0),
)
def test_a_field_of_view_is_what_its_definition_says(
    free: np.ndarray, position: tuple[float, float, float], yaw: float, tilt: float
) -> None:
    free = free.copy()
    column, row = math.floor(position[0]), math.floor(position[1])
    if 0 <= column < 7 and 0 <= row < 6:
        free[row, column] = True
    grid = Grid(free, 1.0)
    pans = (-50.0, 0.0, 35.0)
    camera = Camera.model_validate(
        {
            "name": "c",
            "mount": {"position_m": position, "yaw_deg": yaw},
            "zoom_hfov": ((1, 55.0),),
            "image": {"width": 10, "height": 10},
            "max_depth_m": 4.0,
            "presets": tuple({"name": str(pan), "pan": pan, "tilt": tilt, "zoom": 1} for pan in pans),
        }
    )
    site = Site("random", None, "", grid, Targets(), Control(), (camera,))
    expected = np.array([[in_view(grid, camera, cell, pan, tilt) for cell in grid.cells.tolist()] for pan in pans])
    if expected.any(axis=1).all():
        found = build_views(site).detection[0] > 0
        assert np.count_nonzero(found != expected) <= 1  # a sampled ray may slip through a corner
        assert np.all(found <= expected) or np.all(found >= expected)
    else:
        with pytest.raises(SiteError, match="sees no free cell"):
            build_views(site)


@pytest.mark.example
def test_a_drawn_field_of_view(tmp_path: Path) -> None:
    # 60 degrees wide and high, looking along the diagonal 45 degrees down from 2 m. With s = x + y of a cell's centre
    # it lies s / 2 + sqrt 2 along the axis: within 4 m up to s = 5, and in the picture if |y - x| <= 0.408 s + 1.155.
    site = load_site(written(tmp_path, HEAD + 'presets = [{ name = "p", pan = 0, tilt = -45, zoom = 1 }]\n'))
    marks = np.full(site.grid.free.shape, "#")
    marks[site.grid.free] = np.where(build_views(site).detection[0][0] > 0, "o", ".")
    assert ["".join(row) for row in marks[::-1]] == [
        ".....",
        ".o...",
        "oo#..",
        "oooo.",
        "ooo..",
    ]


@pytest.mark.example
@pytest.mark.parametrize(
    ("preset", "why"),
    [
        ("pan = 180, tilt = -45", "a pan, tilt and zoom whose picture holds the centre of a free cell"),
        ("pan = 0, tilt = 60", "a pan, tilt and zoom whose picture holds the centre of a free cell"),
        ("pan = 0, tilt = 0", "a free cell within the depth of 4 m"),
    ],
)
def test_a_preset_that_sees_nothing_is_refused_with_the_reason(tmp_path: Path, preset: str, why: str) -> None:
    good = '{ name = "good", pan = 0, tilt = -45, zoom = 1 }'
    text = HEAD.replace("max_depth_m = 4", "max_depth_m = 4\n") + (
        f'presets = [{good}, {{ name = "bad", {preset}, zoom = 1 }}]\n'
    )
    text = text.replace("2.0], yaw", "2.6], yaw") if "tilt = 0" in preset else text
    with pytest.raises(SiteError) as caught:
        build_views(load_site(written(tmp_path, text)))
    assert [fault.where for fault in caught.value.faults] == ["cameras[0].presets[1]"]
    assert 'preset "bad" of camera "a"' in str(caught.value)
    assert why in str(caught.value)


@pytest.mark.example
def test_a_preset_that_looks_into_a_wall_is_refused_with_the_reason(tmp_path: Path) -> None:
    rows = '".....", ".....", "..#..", ".....", "....."'
    text = HEAD.replace(rows, '".....", ".....", ".....", "#####", "#####"').replace(
        "max_depth_m = 4", "max_depth_m = 9"
    )
    with pytest.raises(SiteError, match="expected a clear view: walls hide all 13 free cells"):
        build_views(load_site(written(tmp_path, text + 'presets = [{ name = "p", pan = 0, tilt = -45, zoom = 1 }]\n')))


@pytest.mark.example
@pytest.mark.parametrize(
    ("polygon", "refused"),
    [
        ("[[1.2, 1.2], [1.4, 1.2], [1.3, 1.4]]", True),  # smaller than a cell, in the middle of the picture
        ("[[4.2, 0.2], [4.9, 0.2], [4.9, 0.8]]", False),  # beside the picture
        ("[[2.1, 2.1], [2.9, 2.1], [2.9, 2.9]]", False),  # inside the pillar
        ("[[3.2, 3.2], [3.8, 3.2], [3.8, 3.8], [3.2, 3.8]]", False),  # behind the pillar
        ("[[0.2, 4.0], [2.0, 4.0], [2.0, 5.0], [0.2, 5.0]]", True),  # beyond the depth, but in the picture
        ("[[-9, -9], [9, -9], [9, 9], [-9, 9]]", True),  # all of it
        ("[[-3, -3], [-1, -3], [-1, -1]]", False),  # behind the camera
    ],
)
def test_a_preset_that_looks_into_a_private_area_is_refused(tmp_path: Path, polygon: str, refused: bool) -> None:
    text = HEAD + 'presets = [{ name = "p", pan = 0, tilt = -45, zoom = 1 }]\n'
    site = load_site(written(tmp_path, text + f"[[privacy]]\npolygon_m = {polygon}\n"))
    if refused:
        with pytest.raises(
            SiteError, match=r'presets\[0\]: found preset "p" of camera "a" that looks into privacy\[0\]'
        ):
            build_views(site)
    else:
        assert build_views(site).detection[0].any()


@pytest.mark.example
def test_detection_probability_and_noise_come_from_the_site() -> None:
    perfect = build_views(load_site("tiny"))
    poor = build_views(load_site("tiny").with_overrides(detection_probability=0.8, cell_noise_m=0.5))
    for one, other in zip(perfect.detection, poor.detection, strict=True):
        assert set(np.unique(one)) == {0.0, 1.0}
        assert np.array_equal(one * 0.8, other)
    assert (perfect.noise_m, poor.noise_m) == ((0.0, 0.0), (0.5, 0.5))


@pytest.mark.example
def test_seeing_together_is_a_noisy_or() -> None:
    views = Views((np.array([[0.5, 0.0, 0.2]]), np.array([[0.5, 0.3, 0.0], [1.0, 0.0, 0.0]])), (0.0, 0.0))
    assert views.seen([0, 0]) == pytest.approx([0.75, 0.3, 0.2])
    assert views.seen([0, 1]) == pytest.approx([1.0, 0.0, 0.2])
    assert views.seen([None, 0]) == pytest.approx([0.5, 0.3, 0.0])
    assert views.seen([None, None]) == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "best", "union"),
    [("hall", 86, 160), ("corridor", 71, 160), ("junction", 82, 140), ("tiny", 10, 14), ("micro", 2, 3)],
)
def test_no_joint_preset_sees_the_whole_floor(name: str, best: int, union: int) -> None:
    views = build_views(load_site(name))
    joint = [
        np.count_nonzero(views.seen(presets)) for presets in product(*(range(len(one)) for one in views.detection))
    ]
    assert max(joint) == best
    assert np.count_nonzero(np.any([one.any(axis=0) for one in views.detection], axis=0)) == union
    chosen, how = best_joint_coverage(views)
    assert (np.count_nonzero(views.seen(chosen)), how) == (best, "the best")


@pytest.mark.example
@pytest.mark.parametrize("name", ["hall", "corridor", "junction"])
def test_the_presets_of_one_camera_see_mostly_different_cells(name: str) -> None:
    for detection in build_views(load_site(name)).detection:
        for one, other in product(detection > 0, repeat=2):
            if one is not other and not np.array_equal(one, other):
                assert np.count_nonzero(one & other) <= 0.2 * min(one.sum(), other.sum())


@pytest.mark.example
def test_the_hall_is_symmetric_under_half_a_turn() -> None:
    site = load_site("hall")
    views = build_views(site)
    for camera, opposite in ((0, 3), (1, 2)):
        for preset in range(3):
            first, turned = (views.detection[i][preset].reshape(10, 20) for i in (camera, opposite))
            assert np.array_equal(first, turned[::-1, ::-1])


@pytest.mark.example
def test_equal_coverage_keeps_most_cameras_where_they_start() -> None:
    """Presets (0, 1, 1) and (1, 0, 0) both see all three cells; the second, later in order, moves one camera only."""
    one, two, three = np.eye(3)
    turning = (np.array([one, two + three]), np.array([one, two]), np.array([one, three]))
    assert best_joint_coverage(Views(turning, (0.0,) * 3)) == ((1, 0, 0), "the best")


@pytest.mark.example
def test_many_cameras_are_improved_one_after_the_other() -> None:
    rng = np.random.default_rng(1)
    detection = tuple((rng.random((3, 40)) < 0.1).astype(float) for _ in range(8))
    views = Views(detection, (0.0,) * 8)
    presets, how = best_joint_coverage(views)
    assert how == "a good"
    covered = np.count_nonzero(views.seen(presets))
    for camera, preset in product(range(8), range(3)):
        other = [*presets[:camera], preset, *presets[camera + 1 :]]
        assert np.count_nonzero(views.seen(other)) <= covered


@pytest.mark.example
def test_static_cameras_see_all_that_no_wall_hides() -> None:
    site = load_site("junction")
    seen = static_views(site)
    assert seen.shape == (2, 168)
    assert not seen.all(axis=1).any()
    assert seen.any(axis=0).all()
    assert static_views(load_site("hall")).all()


@pytest.mark.example
def test_the_example_office_keeps_its_private_room_private() -> None:
    site = load_site(EXAMPLE)
    views = build_views(site)
    (x0, y0), (x1, y1) = (
        np.array(site.privacy[0].polygon_m).min(axis=0),
        np.array(site.privacy[0].polygon_m).max(axis=0),
    )
    inside = np.all((site.grid.centres_m > (x0, y0)) & (site.grid.centres_m < (x1, y1)), axis=1)
    assert inside.sum() > 30
    assert all(not one[:, inside].any() for one in views.detection)
