"""The animation of a run and its still."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from PIL import Image

from surveillance_domain.model.views import build_views
from surveillance_domain.pictures.animation import draw_frame, write_animation
from surveillance_domain.pictures.scene import Frame, draw_scene
from surveillance_domain.pictures.style import INK, WALL, save_figure
from surveillance_domain.site.load import load_site

SITE = load_site("junction")
VIEWS = build_views(SITE)


def frame(number: int, belief: bool = True) -> Frame:
    expected = np.zeros(SITE.grid.size)
    expected[3 * number] = 1.0
    positions = SITE.grid.centres_m[[3 * number, 5]]
    presets = (number % 3, 0, None, 1)
    return Frame(number, positions, np.array([True, False]), presets, expected if belief else None, 50.0)


@pytest.mark.end_to_end
def test_the_animation_has_every_step_and_is_small(tmp_path: Path) -> None:
    write_animation(SITE, VIEWS, [frame(number) for number in range(1, 5)], "junction", tmp_path / "run.gif")
    with Image.open(tmp_path / "run.gif") as picture:
        assert picture.n_frames == 4
        assert picture.info["loop"] == 0
        seen = []
        for number in range(picture.n_frames):
            picture.seek(number)
            seen.append(np.asarray(picture.convert("RGB")).astype(int))
    assert all((a != b).any() for a, b in pairwise(seen))
    walls = [int(WALL[i : i + 2], 16) for i in (1, 3, 5)]
    share = (np.abs(seen[0] - walls).max(axis=2) <= 4).mean()
    assert 0.1 < share < 0.9
    assert (tmp_path / "run.gif").stat().st_size < 1_000_000
    assert [path.name for path in tmp_path.iterdir()] == ["run.gif"]


@pytest.mark.end_to_end
def test_a_failure_leaves_the_old_animation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "run.gif").write_bytes(b"old")

    def fail(self: Image.Image, file: object, *arguments: object, **options: object) -> None:
        file.write(b"half")  # type: ignore[attr-defined]
        raise OSError("disk full")

    monkeypatch.setattr(Image.Image, "save", fail)
    with pytest.raises(OSError, match="disk full"):
        write_animation(SITE, VIEWS, [frame(1)], "junction", tmp_path / "run.gif")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("run.gif", b"old")]
    with pytest.raises(ValueError, match="a frame at least"):
        write_animation(SITE, VIEWS, [], "junction", tmp_path / "run.gif")


@pytest.mark.example
def test_a_scene_shows_what_the_frame_says() -> None:
    scene = draw_scene(SITE, VIEWS, frame(1), "junction, controller P")
    assert scene.title.get_text() == "junction, controller P\nstep 1: 1 of 2 observed, PercentObs so far 50.0 %"
    np.testing.assert_allclose(scene.dots.get_offsets(), SITE.grid.centres_m[[3, 5]])
    np.testing.assert_allclose(scene.dots.get_facecolors(), [to_rgba(INK), to_rgba("#ffffff")])
    shown = [len(lines.get_segments()) > 0 for lines in scene.outlines]
    assert shown == [True, True, False, True]
    ground = np.asarray(scene.floor.get_array())[SITE.grid.free]
    assert ground[3].mean() < 0.45  # one expected target: dark
    unseen = VIEWS.seen(frame(1).presets) == 0
    unseen[3] = False
    np.testing.assert_allclose(ground[unseen], 1.0)
    scene.show(frame(2))
    moved = np.asarray(scene.floor.get_array())[SITE.grid.free]
    assert moved[6].mean() < 0.45 < moved[3].mean()


@pytest.mark.end_to_end
def test_a_still_without_belief_has_no_colour_bar(tmp_path: Path) -> None:
    with_belief, without = (draw_frame(SITE, VIEWS, frame(1, belief), "junction") for belief in (True, False))
    assert (len(with_belief.axes), len(without.axes)) == (2, 1)
    png, svg = save_figure(without, tmp_path / "still.png")
    assert png.exists()
    assert svg.exists()
