"""One browser: its document, and how a step changes it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.model.build import Surveillance
from surveillance_domain.page.curves import Curves
from surveillance_domain.page.feed import COURSE_STEPS, Feed
from surveillance_domain.page.floor_plan import FloorPlan
from surveillance_domain.page.gallery import gallery
from surveillance_domain.page.headline import headline
from surveillance_domain.page.health import HealthTable
from surveillance_domain.pictures.scene import HEAT_COLOURS

if TYPE_CHECKING:
    from bokeh.document import Document
    from jinja2 import Template

__all__ = ["Content", "Session"]

_ALL = "all targets together"
_LOOK_AGAIN_MS = 2000
_OVERDUE_STEPS, _OVERDUE_S = 3, 5.0

_LOST = "document.getElementById('lost').hidden = {hidden}"
_JOINED = "document.getElementById('joining').hidden = true"


@dataclass(frozen=True, eq=False)
class Content:
    """What the page is about.

    Attributes
    ----------
    surveillance : Surveillance
    controller : str
    holds : WatchState
    truth, belief, pictures : bool
        Whether there is a truth, whether the controller has a belief, whether pictures are looked at.
    """

    surveillance: Surveillance
    controller: str
    holds: WatchState
    truth: bool
    belief: bool
    pictures: bool


class Session:
    """Fills the document of a browser; after that, every method is called with the document's lock held."""

    def __init__(self, document: Document, content: Content, feed: Feed) -> None:
        from bokeh.models import CustomJS, Div, Select

        self._document, self._content, self._feed = document, content, feed
        targets = content.surveillance.targets
        site, styles = content.surveillance.site, _text("widgets.css")
        wide = {"sizing_mode": "stretch_width", "stylesheets": [styles], "disable_math": True}
        self._plan = FloorPlan(content.surveillance)
        self._curves = Curves(len(targets), content.truth)
        self._health = HealthTable(site.cameras, content.holds, styles, self.update)
        self._headline, self._gallery = Div(name="headline", **wide), Div(name="gallery", **wide)
        self._select = Select(
            title="Belief of",
            value=_ALL,
            options=[_ALL, *targets],
            name="belief",
            visible=content.belief,
            width=220,
        )
        self._select.on_change("value", lambda attribute, old, new: self._show_belief())
        for root in (self._headline, self._select, self._plan.figure, *self._curves.figures, self._health.layout):
            document.add_root(root)
        if content.pictures:
            document.add_root(self._gallery)
        summary = f"{content.controller}, {len(targets)} target{'s' if len(targets) > 1 else ''}"
        document.title = f"{site.name}: {summary}"
        document.template = _template()
        document.template_variables.update(
            {
                "site": site.name,
                "summary": summary,
                "aspect": f"{self._plan.aspect:.4f}",
                "heat_colours": ", ".join(HEAT_COLOURS),
                "course_steps": COURSE_STEPS,
                "has_belief": content.belief,
                "has_truth": content.truth,
                "has_pictures": content.pictures,
            }
        )
        document.config.notify_connection_status = False  # the page says so itself, where nobody can miss it
        document.js_on_event("document_ready", CustomJS(code=_JOINED))
        document.js_on_event("connection_lost", CustomJS(code=_LOST.format(hidden="false")))
        document.js_on_event("client_reconnected", CustomJS(code=_LOST.format(hidden="true")))
        self._overdue_s = _OVERDUE_STEPS * site.control.step_s + _OVERDUE_S
        self.update()
        document.add_periodic_callback(self._look_again, _LOOK_AGAIN_MS)

    def update(self) -> None:
        """Show the last step, as one message to the browser."""
        latest = self._feed.latest()
        self._document.hold("combine")
        try:
            if latest is None:
                self._headline.text = headline(None)
                self._health.show_holds()
                return
            snapshot = latest.snapshot
            self._headline.text = headline(snapshot, latest.age_s, self._overdue_s)
            self._offer(snapshot.targets)
            self._plan.show(snapshot, self._target)
            self._curves.show(latest.course)
            self._health.show(snapshot.cameras)
            if self._content.pictures:
                names = [camera.name for camera in snapshot.cameras]
                shown = gallery(names, latest.pictures, snapshot.number)
                self._gallery.text = f'<div class="gallery">{shown}</div>'
        finally:
            self._document.unhold()

    @property
    def _target(self) -> str | None:
        return None if self._select.value == _ALL else str(self._select.value)

    def _offer(self, targets: tuple[str, ...]) -> None:
        """Let the user choose among those that there are now."""
        if self._select.value not in (_ALL, *targets):
            self._select.value = _ALL
        if self._select.options != [_ALL, *targets]:
            self._select.options = [_ALL, *targets]

    def _show_belief(self) -> None:
        latest = self._feed.latest()
        if latest is not None:
            self._plan.show_belief(latest.snapshot, self._target)

    def _look_again(self) -> None:
        """What changes without a step: how late the next one is, and what other commands hold."""
        latest = self._feed.latest()
        if latest is not None:
            self._headline.text = headline(latest.snapshot, latest.age_s, self._overdue_s)
        self._health.show_holds()


@cache
def _text(name: str) -> str:
    return files("surveillance_domain.page").joinpath(name).read_text(encoding="utf-8")


@cache
def _template() -> Template:
    from jinja2 import Template

    return Template(_text("page.html"))
