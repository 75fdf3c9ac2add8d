"""The figure of a comparison."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.text import Annotation

from surveillance_domain.pictures.comparison import Curve, Panel, draw_comparison, spread
from surveillance_domain.pictures.style import save_figure

COUNTS = (1, 5, 10)


def curve(name: str, *means: float) -> Curve:
    counts = COUNTS[: len(means)]
    return Curve(name, name.upper(), counts, means, tuple(m - 2 for m in means), tuple(m + 2 for m in means))


@pytest.mark.example
def test_every_site_is_a_panel_and_every_controller_a_line_with_its_name() -> None:
    curves = (curve("pomdp", 70.0, 60.0, 50.0), curve("mp", 55.0, 50.0, 49.9), curve("clairvoyant", 90.0, 80.0, 71.0))
    figure = draw_comparison(
        [Panel(name, curves) for name in ("hall", "corridor", "junction", "lego")], "title", "note"
    )
    shown = [axes for axes in figure.axes if axes.axison]
    assert [axes.get_title() for axes in shown] == ["hall", "corridor", "junction", "lego"]
    for axes in shown:
        drawn = [line.get_ydata().tolist() for line in axes.lines]
        assert drawn == [list(one.mean) for one in curves]
        assert [text.get_text() for text in axes.texts if isinstance(text, Annotation)] == [
            "POMDP",
            "MP",
            "CLAIRVOYANT",
        ]
        assert axes.get_ylim() == (40.0, 100.0)
        looks = {(line.get_color(), str(line.get_linestyle()), line.get_marker()) for line in axes.lines}
        assert len({marker for _, _, marker in looks}) == 3
        bound = axes.lines[2]
        assert bound.get_linewidth() < axes.lines[0].get_linewidth()
        assert bound.get_marker() == "None"


@pytest.mark.end_to_end
def test_one_number_of_targets_and_one_run_can_be_drawn_too(tmp_path: Path) -> None:
    lonely = Curve("pomdp", "P", (5,), (50.0,), (-math.inf,), (math.inf,))
    other = Curve("mine", "Mine", (5,), (50.0,), (40.0,), (60.0,))
    png, svg = save_figure(draw_comparison([Panel("hall", (lonely, other))], "title"), tmp_path / "one.png")
    assert png.stat().st_size > 1000
    assert svg.read_bytes().endswith(b"</svg>\n")


@pytest.mark.example
def test_labels_that_would_lie_upon_each_other_are_moved_apart() -> None:
    np.testing.assert_allclose(spread(np.array([50.0, 50.0, 80.0]), 4.0, 0.0, 100.0), [48.0, 52.0, 80.0])
    np.testing.assert_allclose(spread(np.array([10.0, 1.0]), 4.0, 3.0, 100.0), [10.0, 3.0])


@pytest.mark.property
@given(st.lists(st.floats(0, 100), min_size=1, max_size=9))
def test_labels_keep_their_order_their_distance_and_the_frame(heights: list[float]) -> None:
    placed = spread(np.array(heights), 5.0, 0.0, 100.0)
    in_order = placed[np.argsort(heights, kind="stable")]
    assert (np.diff(in_order) >= 5.0 - 1e-9).all()
    assert in_order[0] >= -1e-9
    assert in_order[-1] <= 100.0 + 1e-9
    if len(heights) == 1:
        assert placed[0] == pytest.approx(heights[0])
