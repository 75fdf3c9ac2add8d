"""The table of cameras, with a button to take each one or give it back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.page.palette import camera_colour
from surveillance_domain.page.snapshot import CameraSnapshot
from surveillance_domain.site.camera import Camera

if TYPE_CHECKING:
    from bokeh.models import Column

__all__ = ["HealthTable", "health_row", "holder"]

_HOLD, _RELEASE = "Hold", "Release"
_COLUMNS = ("camera", "state", "looks at", "lost views", "held by", "last fault")


class HealthTable:
    """Rows of text and button, for one browser.

    Parameters
    ----------
    cameras : sequence of Camera
    holds : WatchState
        Says whom people hold, and is told of the buttons.
    styles : str
        CSS of the rows.
    pressed : callable
        Called when a camera was taken or given back.

    Attributes
    ----------
    layout : bokeh.models.Column
    """

    def __init__(self, cameras: Sequence[Camera], holds: WatchState, styles: str, pressed: Callable[[], None]) -> None:
        from bokeh.models import Button, Column, Div, Row

        self._cameras, self._holds, self._pressed = cameras, holds, pressed
        wide = {"sizing_mode": "stretch_width", "stylesheets": [styles], "disable_math": True}
        self._rows = [Div(name=f"health-{camera.name}", **wide) for camera in cameras]
        self._buttons = [Button(label=_HOLD, name=f"hold-{one.name}", width=92, align="center") for one in cameras]
        for camera, button in zip(cameras, self._buttons, strict=True):
            button.on_click(partial(self._press, camera.name, button))
        titles = "".join(f"<span>{title}</span>" for title in _COLUMNS)
        heading = Div(text=f'<div class="row titles">{titles}</div>', margin=(0, 102, 0, 5), **wide)
        rows = [Row(*pair, sizing_mode="stretch_width") for pair in zip(self._rows, self._buttons, strict=True)]
        self.layout: Column = Column(heading, *rows, name="health", sizing_mode="stretch_width")

    def show(self, cameras: Sequence[CameraSnapshot]) -> None:
        """Set every row to how its camera is, and every button to what it would do now."""
        for number, (camera, now) in enumerate(zip(self._cameras, cameras, strict=True)):
            view = None if now.view is None else camera.presets[now.view].name
            self._rows[number].text = health_row(now, view or _place(now), camera_colour(number))
        self.show_holds()

    def show_holds(self) -> None:
        """Set the buttons alone."""
        held = self._holds.held()
        for camera, button in zip(self._cameras, self._buttons, strict=True):
            button.label = _RELEASE if camera.name in held else _HOLD
            button.button_type = "warning" if camera.name in held else "default"

    def _press(self, name: str, button: object) -> None:
        """Do what the button said, which somebody else may have done meanwhile."""
        self._holds.hold(name, getattr(button, "label", _HOLD) == _HOLD)
        self._pressed()


def holder(state: str) -> str:
    """Who has a camera, from its state; empty if the watch does."""
    return {"held": "hold or this page", "moved by somebody else": "somebody else"}.get(state, "")


def _place(camera: CameraSnapshot) -> str | None:
    """Where a camera looks that looks at no preset of its own."""
    if camera.private:
        return "a private area"
    if camera.place is None:
        return None
    pan, tilt, _ = camera.place
    return f"pan {pan:.0f}°, tilt {tilt:.0f}°"


def health_row(camera: CameraSnapshot, view: str | None, colour: str) -> str:
    """HTML of one camera's row."""
    kind = "ready" if camera.state == "ready" else "taken" if holder(camera.state) else "away"
    cells = (
        f'<i style="background:{colour}"></i><b>{escape(camera.name)}</b>',
        f'<em class="{kind}">{escape(camera.state)}</em>',
        "nothing" if view is None else escape(view),
        str(camera.failures),
        escape(holder(camera.state)),
        escape("" if holder(camera.state) else camera.because),
    )
    shown = "".join(_cell(title, cell) for title, cell in zip(_COLUMNS, cells, strict=True))
    return f'<div class="row">{shown}</div>'


def _cell(title: str, content: str) -> str:
    return f'<span data-title="{title}" class="{"told" if content else "none"}">{content or "–"}</span>'
