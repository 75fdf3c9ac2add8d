"""Pictures: markers lie where they should, the nearer hides the farther, walls hide what the model says they hide."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.model.line_of_sight import line_of_sight
from surveillance_domain.model.looks import looks
from surveillance_domain.model.pinhole import Pinhole, pinhole
from surveillance_domain.site.load import load_site

cv2 = pytest.importorskip("cv2")

from surveillance_domain.emulation.rendering import Renderer  # noqa: E402
from surveillance_domain.emulation.solids import walls  # noqa: E402
from surveillance_domain.site.grid import Grid  # noqa: E402

LEGO = load_site("lego")
ROBOTS = Renderer(LEGO, looks(LEGO, 2), np.random.default_rng(0))
QUIET = Renderer(LEGO, looks(LEGO, 2), np.random.default_rng(0), noise=0.0)


def seen(renderer: Renderer, hole: Pinhole, places: Sequence[tuple[float, float]], headings: Sequence[float]) -> dict:
    """Corners of the markers that OpenCV finds, by their numbers."""
    picture = renderer.picture(hole, np.array(places, dtype=float), np.array(headings, dtype=float))
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    corners, numbers, _ = detector.detectMarkers(picture)
    return {} if numbers is None else dict(zip(numbers.ravel().tolist(), corners, strict=True))


@pytest.mark.property
@settings(max_examples=30)
@given(
    st.integers(0, 2), st.integers(0, 2), st.floats(-0.3, 0.3), st.floats(0.9, 1.8), st.floats(-3.1, 3.1), st.booleans()
)
def test_markers_are_found_where_they_lie(
    camera: int, preset: int, aside: float, away: float, heading: float, smaller: bool
) -> None:
    """Through a detector of others: pixel to floor by the pinhole, and heading too."""
    description = LEGO.cameras[camera]
    chosen = description.presets[preset]
    size = (640, 480) if smaller else None
    hole = pinhole(description, chosen.pan, chosen.tilt, chosen.zoom, size)
    forward = hole.axes[:2, 0] / np.linalg.norm(hole.axes[:2, 0])
    place = hole.position_m[:2] + away * forward + aside * np.array([-forward[1], forward[0]])
    found = seen(ROBOTS, hole, [(50.0, 50.0), tuple(place)], [0.0, heading])
    corners = hole.on_plane(found[1][0].astype(float), 0.10)
    np.testing.assert_allclose(corners.mean(axis=0), place, atol=0.004)
    # the first corner is the marker's upper left; its lower edge runs along the heading
    lower_left, lower_right = corners[3], corners[2]
    along = lower_right - lower_left
    assert np.linalg.norm(along) == pytest.approx(0.12, rel=0.06)
    turn = np.arctan2(along[1], along[0]) - heading
    assert abs((turn + np.pi) % (2 * np.pi) - np.pi) < 0.08


@pytest.mark.example
def test_the_nearer_robot_hides_the_farther() -> None:
    south = LEGO.cameras[0]
    hole = pinhole(south, 0.0, -10.0, 1.0)  # low, so that robots overlap
    low = Pinhole(np.array([1.5, -0.3, 0.25]), hole.axes, hole.focal_px, hole.width, hole.height)
    near, far = (1.5, 0.7), (1.5, 0.95)
    for order, colour in (((near, far), 2), ((far, near), 0)):  # red is target 0, blue is target 1
        picture = QUIET.picture(low, np.array(order), np.zeros(2))
        front = low.project(np.array([[1.5, 0.6, 0.05]]))[0].round().astype(int)
        pixel = picture[front[1], front[0]].astype(int)
        assert pixel[colour] > 60
        assert pixel[2 - colour] < 20
        behind = low.project(np.array([[1.5, 0.85, 0.05]]))[0].round().astype(int)  # the front of the farther one
        pixel = picture[behind[1], behind[0]].astype(int)
        assert pixel[2 - colour] < 20


@pytest.mark.example
def test_walls_hide_what_the_model_says_they_hide() -> None:
    """On the junction every free cell in the picture is either floor, or hidden: as `line_of_sight` says."""
    site = load_site("junction")
    renderer = Renderer(site, (), np.random.default_rng(0), noise=0.0)
    no_targets = (np.zeros((0, 2)), np.zeros(0))
    compared = 0
    for camera in site.cameras:
        place = np.array(camera.mount.position_m[:2], dtype=float)
        visible = line_of_sight(site.grid, place, site.grid.centres_m)
        for preset in camera.presets[::2]:
            hole = pinhole(camera, preset.pan, preset.tilt, preset.zoom, (480, 360))
            picture = renderer.picture(hole, *no_targets)
            pixels = hole.project(np.column_stack([site.grid.centres_m, np.zeros(site.grid.size)]))
            inside = ((pixels > 4) & (pixels < [hole.width - 5, hole.height - 5])).all(axis=1)
            for (u, v), clear in zip(pixels[inside].round().astype(int), visible[inside], strict=True):
                patch = picture[v - 1 : v + 2, u - 1 : u + 2].reshape(-1, 3)
                # walls are of one colour, the floor is speckled
                assert (patch.std(axis=0).max() > 0.5) == clear
                compared += 1
    assert compared > 100


@pytest.mark.example
def test_a_block_has_four_sides_and_a_top() -> None:
    grid = Grid.from_rows([".....", ".##..", ".##..", "....."], 0.5, (10.0, 20.0))
    faces = walls(grid, 2.0, (200, 200, 200))
    assert len(faces) == 4 + 2  # sides in one piece each, the top row by row
    normals = []
    for face in faces:
        a, b, c = face.corners_m[:3]
        normal = np.cross(b - a, c - a)
        normals.append(tuple((normal / np.linalg.norm(normal)).round(9) + 0.0))
        outwards = face.corners_m.mean(axis=0) - np.array([11.0, 21.0, 1.0])
        assert normal @ outwards > 0
    assert sorted(normals) == sorted([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, 1)])
    corners = np.vstack([face.corners_m for face in faces])
    np.testing.assert_allclose(corners.min(axis=0), [10.5, 20.5, 0.0])
    np.testing.assert_allclose(corners.max(axis=0), [11.5, 21.5, 2.0])


@pytest.mark.example
def test_noise_has_its_size_and_differs_from_picture_to_picture() -> None:
    hole = pinhole(LEGO.cameras[0], 0.0, -40.0, 1.0)
    nothing = (np.full((2, 2), 50.0), np.zeros(2))
    clean = QUIET.picture(hole, *nothing).astype(float)
    first, second = (ROBOTS.picture(hole, *nothing).astype(float) for _ in range(2))
    assert (first - second).std() == pytest.approx(3 * 2**0.5, rel=0.05)
    assert np.array_equal(clean, QUIET.picture(hole, *nothing))
