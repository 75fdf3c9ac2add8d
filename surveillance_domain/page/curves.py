"""The course of the last steps: PercentObs, and targets expected against targets seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from surveillance_domain.page.feed import COURSE_STEPS, Point
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK

if TYPE_CHECKING:
    from bokeh.plotting import figure

__all__ = ["Curves"]

_SEEN, _EXPECTED = INK, CAMERA_COLOURS[1]


class Curves:
    """Two figures over the steps, for one browser.

    Parameters
    ----------
    targets : int
    truth : bool
        Whether there is one; without it there is no PercentObs.

    Attributes
    ----------
    figures : list of bokeh.plotting.figure
    """

    def __init__(self, targets: int, truth: bool) -> None:
        from bokeh.models import ColumnDataSource, Range1d

        self._source = ColumnDataSource({"step": [], "percent": [], "expected": [], "seen": []}, name="course")
        self._last, self._steps = 0, Range1d(0, 1)
        share = _figure("percent-obs", "PercentObs so far, in %", self._steps, 102.0)
        share.line("step", "percent", source=self._source, line_width=2.5, color=CAMERA_COLOURS[0])
        share.visible = truth
        counts = _figure("expected-seen", "targets seen and expected, in each step", self._steps, targets * 1.04)
        lines: dict[str, Any] = {"source": self._source, "line_width": 2}
        counts.step("step", "seen", mode="center", color=_SEEN, legend_label="seen", **lines)
        counts.step("step", "expected", mode="center", color=_EXPECTED, legend_label="expected", **lines)
        counts.yaxis.ticker.min_interval = 1
        counts.legend.orientation = "horizontal"
        counts.legend.label_text_font_size = "12px"
        counts.legend.border_line_color = None
        counts.legend.padding = counts.legend.margin = 2
        counts.add_layout(counts.legend[0], "below")
        self.figures = [share, counts]

    def show(self, course: Sequence[Point]) -> None:
        """Add the steps that are not shown yet."""
        new = [point for point in course if point.number > self._last]
        if not new:
            return
        self._last = new[-1].number
        added = {
            "step": [point.number for point in new],
            "percent": [_number(point.percent_obs) for point in new],
            "expected": [_number(point.expected) for point in new],
            "seen": [point.seen for point in new],
        }
        self._source.stream(added, rollover=COURSE_STEPS)
        self._steps.update(start=course[0].number - 0.5, end=self._last + 0.5)


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _figure(name: str, title: str, steps: Any, highest: float) -> figure:
    from bokeh.plotting import figure

    made = figure(
        name=name,
        title=title,
        x_range=steps,
        y_range=(0, highest),
        height=190,
        sizing_mode="stretch_width",
        toolbar_location=None,
        tools="",
        background_fill_alpha=0,
        border_fill_alpha=0,
        outline_line_color=None,
        min_border_left=34,
    )
    made.title.text_font_size = "13px"
    made.title.text_font_style = "normal"
    made.title.text_color = INK
    made.axis.major_label_text_font_size = "12px"
    made.axis.minor_tick_line_color = None
    made.xgrid.visible = False
    made.ygrid.grid_line_color = "#e3e3e3"
    return made
