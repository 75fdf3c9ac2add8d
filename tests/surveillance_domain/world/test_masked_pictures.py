"""What a privacy mask covers is black in an emulated camera's pictures, and is not used where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.site.camera import PrivacyMask
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.vision.opencv import decoded
from surveillance_domain.vision.points import FloorMarker
from surveillance_domain.world.network import NetworkWorld
from surveillance_domain.world.picture_eyes import PictureEyes
from tests.emulated_watch import model_of

LAID = (FloorMarker(30, (1.2, 1.2)), FloorMarker(31, (1.8, 1.2)))
"""From the southern camera, over x = 1.5 and y = -0.3: at pan -11.3 and 11.3, tilt -38.1."""
MASK = PrivacyMask(pan_deg=(-60.0, 0.0), tilt_deg=(-90.0, 10.0))


def south_alone(*masks: PrivacyMask) -> Site:
    site = load_site("lego")
    south = site.cameras[0].model_copy(update={"privacy_masks": masks, "home": None})
    name = f"{site.digest}, {len(masks)} masks"
    return replace(site, cameras=(south,), digest=name)


def seen(emulated: Site, used: Site) -> tuple[set[int | str], np.ndarray]:
    """Markers that nobody knows of, seen through the middle preset, and the picture."""
    clock = VirtualClock()
    with EmulatedSite(emulated, 1, clock, np.random.default_rng(0), truth="grid", laid=LAID) as emulation:
        south = emulation.site.cameras[0].model_copy(update={"privacy_masks": used.cameras[0].privacy_masks})
        surveillance = replace(model_of(used, 1), site=replace(used, cameras=(south,)))
        eyes = PictureEyes(surveillance)
        cameras = emulation.open_cameras(np.random.default_rng(1))
        world = NetworkWorld(surveillance.site, cameras, eyes, clock)
        try:
            assert world.start(10.0) == {}
            world.move({"south": "middle"})
            world.observe()
            assert eyes.last is not None
            return set(eyes.last.unknown), decoded(eyes.sights["south"].picture.jpeg)
        finally:
            world.close()


@pytest.mark.end_to_end
def test_markers_behind_a_mask_are_not_read() -> None:
    plain, masked = south_alone(), south_alone(MASK)
    found, picture = seen(plain, plain)
    assert found == {30, 31}
    assert picture[:, :300].mean() > 50
    found, picture = seen(masked, plain)  # the camera blackens it, though nobody declared it
    assert found == {31}
    assert picture[:, :340].max() <= 16  # JPEG: not quite black everywhere
    assert picture[:, 370:].mean() > 50
    found, _ = seen(plain, masked)  # declared, but the camera shows it
    assert found == {31}
    found, _ = seen(masked, masked)
    assert found == {31}
