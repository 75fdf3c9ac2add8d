"""The picture of what was learned: its lines hold what they say they hold."""

from __future__ import annotations

import re

import numpy as np
import pytest

from surveillance_domain.pictures.motion_fit import FittedMotion, draw_motion_fit


@pytest.mark.example
def test_people_who_do_as_predicted_fill_the_lines_as_predicted() -> None:
    rng = np.random.default_rng(0)
    headings, turns = rng.uniform(0, 2 * np.pi, 4000), rng.normal(0, 20, 4000)
    paces = rng.normal(1.5, 0.1, 4000), rng.normal(0, 0.2, 4000)
    before = paces[0][:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    after = headings + np.radians(turns)
    after = (paces[0] + paces[1])[:, None] * np.stack([np.cos(after), np.sin(after)], axis=1)
    fitted = FittedMotion(before, after, turns, paces[0], 20.0, 0.2, (1.5,), 1.0, 0.25)
    figure = draw_motion_fit(fitted, "made up", rng)
    _, real, _, _ = figure.axes
    (told,) = [text.get_text() for text in real.get_legend().get_texts()]
    half, most = (int(share) for share in re.findall(r"(\d+)%", told))
    assert half == pytest.approx(50, abs=3)
    assert most == pytest.approx(90, abs=3)
    assert "displacement in 1 s: real, held out" in real.get_title()
