"""Coloured bodies in rendered pictures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.blobs import BlobDetector
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.observe import located
from tests.pictured_targets import pixels_of, preset_view, seen_whole

LEGO = load_site("lego")
RED, BLUE = (255, 0, 0), (0, 0, 255)


def patch(colour: tuple[int, int, int], rows: slice, columns: slice) -> np.ndarray:
    """A grey picture of 100 x 100 pixels with a patch; colours are red, green, blue."""
    picture = np.full((100, 100, 3), 128, dtype=np.uint8)
    picture[rows, columns] = colour[::-1]
    return picture


@pytest.mark.example
def test_a_patch_stands_for_its_middle() -> None:
    (found,) = BlobDetector({"red": RED, "blue": BLUE}, 1.7).detect(patch(RED, slice(20, 41), slice(50, 61)))
    assert found.pixel == pytest.approx((55, 30))
    assert (found.kind, found.identity, found.height_m, found.confidence) == ("blob", "red", 0.85, 1.0)
    assert found.size_px == pytest.approx(math.sqrt(20 * 10))


@pytest.mark.example
def test_red_lies_on_both_ends_of_the_hues() -> None:
    detector = BlobDetector({"red": RED}, 1.0)
    for shade in ((220, 20, 0), (220, 0, 20)):
        assert [one.identity for one in detector.detect(patch(shade, slice(20, 40), slice(20, 40)))] == ["red"]


@pytest.mark.example
def test_a_patch_at_the_edge_is_less_sure() -> None:
    (found,) = BlobDetector({"red": RED}, 1.0).detect(patch(RED, slice(0, 20), slice(50, 60)))
    assert found.confidence == 0.5


@pytest.mark.example
def test_specks_and_other_hues_are_nothing() -> None:
    detector = BlobDetector({"red": RED}, 1.0)
    assert detector.detect(patch(RED, slice(20, 25), slice(20, 25))) == ()
    assert detector.detect(patch((0, 200, 0), slice(20, 60), slice(20, 60))) == ()


@pytest.mark.example
def test_a_hue_of_two_targets_gives_no_identity() -> None:
    detector = BlobDetector({"red": RED, "crimson": (220, 20, 30), "blue": BLUE}, 1.0)
    assert [one.identity for one in detector.detect(patch(RED, slice(20, 40), slice(20, 40)))] == [None]
    assert [one.identity for one in detector.detect(patch(BLUE, slice(20, 40), slice(20, 40)))] == ["blue"]


@pytest.mark.example
def test_colours_without_hue_are_left_out() -> None:
    detector = BlobDetector({"white": (255, 255, 255), "black": (0, 0, 0), "red": RED}, 1.0)
    assert detector.left_out == ("white", "black")
    assert detector.detect(patch((255, 255, 255), slice(20, 40), slice(20, 40))) == ()


@pytest.mark.property
@settings(max_examples=25)
@given(
    camera=st.sampled_from(LEGO.cameras),
    preset=st.sampled_from(["left", "middle", "right"]),
    across=st.floats(0.1, 0.9),
    down=st.floats(0.1, 0.9),
    heading=st.floats(0, 2 * math.pi),
)
def test_a_body_in_view_is_found_where_it_is(
    camera: Camera, preset: str, across: float, down: float, heading: float
) -> None:
    view = preset_view(camera, preset)
    (place,) = view.on_plane(np.array([[across * view.width, down * view.height]]))
    assume(seen_whole(view, place, 0.142, (0.0, 0.1)))
    found = BlobDetector({"red": RED, "blue": BLUE}, 0.1).detect(pixels_of(LEGO, view, [place], [heading]))
    (at,) = [one for one in camera.presets if one.name == preset]
    here = ground(camera, Position(at.pan, at.tilt, at.zoom), (view.width, view.height))
    (one,) = located(here, LEGO.grid, found)
    assert one.detection.identity == "red"
    assert one.point_m == pytest.approx(tuple(place), abs=0.03)
