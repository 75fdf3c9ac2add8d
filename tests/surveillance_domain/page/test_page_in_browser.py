"""The live page in a browser, over emulated cameras with pictures."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cv2")
pytest.importorskip("bokeh")

from surveillance_domain.control.loop import Step
from surveillance_domain.control.watch_state import WatchState
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.page.from_watch import snapshot_of
from surveillance_domain.page.live import LivePage
from surveillance_domain.page.session import Content
from surveillance_domain.world.picture_eyes import PictureEyes
from surveillance_domain.world.truth import Truth
from tests.browser import Browser, headless_chromium
from tests.emulated_watch import Emulated, emulated_watch, lego

TARGETS = 3


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with headless_chromium(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@dataclass
class Shown:
    """A watch and its page."""

    running: Emulated
    page: LivePage
    holds: WatchState
    surveillance: Surveillance
    eyes: PictureEyes
    steps: Iterator[Step] = field(init=False)
    last: Step = field(init=False)

    def __post_init__(self) -> None:
        self.steps = self.running.watch.turns()

    def advance(self, number: int) -> None:
        """Do some steps and show them."""
        for step in islice(self.steps, number):
            self.last = step
            self.page.show(snapshot_of(step, self.running.watch, self.surveillance, self.truth, self.eyes.sights))

    def truth(self) -> Truth:
        return self.running.emulation.truth


@pytest.fixture
def shown(tmp_path: Path, browser: Browser) -> Iterator[Shown]:
    site = lego()
    holds = WatchState(site, tmp_path / "state")
    eyes: list[PictureEyes] = []
    models: list[Surveillance] = []

    def look(emulation: object, drawn: object) -> PictureEyes:
        models.append(surveillance_model(emulation.site, TARGETS))  # type: ignore[attr-defined]
        eyes.append(PictureEyes(models[0]))
        return eyes[0]

    with (
        emulated_watch(site, TARGETS, seed=4, eyes=look, held=holds.held) as running,
        LivePage(Content(models[0], "pomdp", holds, truth=True, belief=True, pictures=True)) as page,
    ):
        yield Shown(running, page, holds, models[0], eyes[0])
        browser.open("about:blank")  # or the page complains that its server is gone
        browser.complaints()


def step_is(browser: Browser, number: int) -> Callable[[], bool]:
    return lambda: browser.text("dl").startswith(f"step\n{number}\n")


def heat(browser: Browser) -> np.ndarray:
    values = browser.run(
        "const one = Bokeh.documents[0].get_model_by_name('map').renderers[0].data_source.data.image[0];"
        "return Array.from(one, value => Number.isNaN(value) ? -1 : value)"
    )
    return np.array(values)


def renderers(browser: Browser, kind: str, column: str) -> list[list[object]]:
    """A column of the sources of all glyphs of a kind on the map."""
    return browser.run(
        "return Bokeh.documents[0].get_model_by_name('map').renderers.filter(one => one.glyph.type == arguments[0])"
        ".map(one => Array.from(one.data_source.data[arguments[1]] ?? []))",
        kind,
        column,
    )


def row(browser: Browser, camera: int) -> str:
    return browser.texts(".row:not(.titles)")[camera]


@pytest.mark.end_to_end
def test_it_loads_and_every_step_changes_it(browser: Browser, shown: Shown, tmp_path: Path) -> None:
    browser.size(1366, 800)
    browser.open(shown.page.url)
    browser.wait(lambda: "Waiting for the first step." in browser.text(".waiting"))
    shown.advance(3)
    browser.wait(step_is(browser, 3))
    before = heat(browser)
    assert before.sum() == pytest.approx(TARGETS, abs=1e-4)
    shown.advance(2)
    browser.wait(step_is(browser, 5))
    summary = shown.running.watch.summary()
    assert f"PercentObs\n{summary['percent_obs']:.1f} %" in browser.text("dl")
    assert np.abs(heat(browser) - before).max() > 0.01
    course = browser.run(
        "return Array.from(Bokeh.documents[0].get_model_by_name('percent-obs').renderers[0].data_source.data.percent)"
    )
    assert len(course) == 5
    assert course[-1] == pytest.approx(summary["percent_obs"])
    truth = shown.running.emulation.truth.positions_m
    assert np.allclose(np.array(renderers(browser, "Scatter", "x")[-1], dtype=float), truth[:, 0])
    seen = [name for name, cell in shown.last.sighting.observations.items() if cell is not None]
    marks = ["diamond" if name in shown.last.sighting.beyond else "square" for name in seen]
    assert renderers(browser, "Scatter", "marker")[1:3] == [marks, marks]
    assert browser.complaints() == []
    origins = browser.run("return performance.getEntriesByType('resource').map(one => new URL(one.name).origin)")
    assert set(origins) == {shown.page.url.rstrip("/")}


@pytest.mark.end_to_end
def test_the_heat_map_can_be_switched_to_one_target(browser: Browser, shown: Shown) -> None:
    shown.advance(2)
    browser.open(shown.page.url)
    browser.wait(step_is(browser, 2))
    (choice,) = browser.deep("select")
    choice.send_keys("red")
    browser.wait(lambda: abs(heat(browser).sum() - 1) < 1e-4)
    red = shown.running.controller.belief.marginal("red.location")
    assert np.allclose(heat(browser), red, atol=1e-6)
    shown.advance(1)
    browser.wait(step_is(browser, 3))
    assert heat(browser).sum() == pytest.approx(1, abs=1e-4)
    assert browser.complaints() == []


@pytest.mark.end_to_end
def test_it_survives_a_cameras_death_and_shows_its_return(browser: Browser, shown: Shown) -> None:
    browser.open(shown.page.url)
    shown.advance(2)
    browser.wait(step_is(browser, 2))
    assert "ready" in row(browser, 0)
    assert renderers(browser, "Quad", "left")[0] != []
    shown.running.emulation.cameras["south"].faults.drop_share = 1.0
    shown.advance(4)
    browser.wait(step_is(browser, 6))
    browser.wait(lambda: "away" in row(browser, 0))
    assert "nothing" in row(browser, 0)
    assert "ready" in row(browser, 1)
    assert renderers(browser, "Quad", "left")[0] == []  # no field of view
    assert renderers(browser, "Scatter", "marker")[0][:2] == ["x", "circle"]
    assert len(browser.deep("figure.old")) == 1
    assert "south, step 2, 4 steps ago" in browser.text("figcaption")
    shown.running.emulation.cameras["south"].faults.drop_share = 0.0
    shown.running.clock.sleep(40.0)  # by then it is tried again
    shown.advance(3)
    browser.wait(step_is(browser, 9))
    browser.wait(lambda: "ready" in row(browser, 0))
    assert renderers(browser, "Quad", "left")[0] != []
    assert browser.complaints() == []


@pytest.mark.end_to_end
def test_it_shows_where_somebody_has_turned_a_camera(browser: Browser, shown: Shown) -> None:
    browser.open(shown.page.url)
    browser.wait(lambda: browser.run("return document.getElementById('joining').hidden") is True)
    shown.advance(2)
    browser.wait(step_is(browser, 2))
    shown.running.emulation.cameras["south"].motors.command({"pan": "20", "tilt": "-40"})
    shown.advance(3)
    browser.wait(step_is(browser, 5))
    browser.wait(lambda: "moved by somebody else" in row(browser, 0))
    assert shown.last.sighting.views["south"] is None
    assert "pan 20°, tilt -40°" in row(browser, 0)
    assert renderers(browser, "Quad", "left")[0] != []
    assert renderers(browser, "Scatter", "marker")[0][0] == "circle"
    assert "cameras with a view\n3 of 3" in browser.text("dl")
    assert browser.complaints() == []


@pytest.mark.end_to_end
def test_a_camera_is_taken_and_given_back_by_its_button(browser: Browser, shown: Shown) -> None:
    shown.advance(1)
    browser.open(shown.page.url)
    browser.wait(step_is(browser, 1))
    browser.deep("button")[1].click()
    browser.wait(lambda: shown.holds.held() == {"north-west"})
    browser.wait(lambda: browser.texts("button") == ["Hold", "Release", "Hold"])
    shown.advance(1)
    browser.wait(lambda: "held" in row(browser, 1))
    assert shown.last.sighting.held == {"north-west"}
    shown.holds.hold("south")  # by `surveillance hold`, say
    browser.wait(lambda: browser.texts("button")[0] == "Release")
    browser.deep("button")[1].click()
    browser.wait(lambda: shown.holds.held() == {"south"})
    assert browser.complaints() == []


@pytest.mark.end_to_end
@pytest.mark.parametrize(("width", "height", "mobile"), [(1366, 800, False), (390, 844, True)])
def test_it_fits_a_laptop_and_a_phone(
    browser: Browser, shown: Shown, tmp_path: Path, width: int, height: int, mobile: bool
) -> None:
    from PIL import Image

    shown.advance(2)
    browser.size(width, height, mobile)
    browser.open(shown.page.url)
    browser.wait(step_is(browser, 2))
    assert browser.run("return document.documentElement.scrollWidth") <= width
    plan = browser.deep(".bk-Figure")[0]
    share = plan.rect["width"] / width
    assert (0.85 < share < 1) if mobile else (0.4 < share < 0.7)
    with Image.open(io.BytesIO(plan.screenshot_as_png)) as picture:
        colours = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)
    assert len(colours) > 20  # belief, fields of view, cameras
    assert min(one.rect["height"] for one in browser.deep("button")) >= 28
    pictures = [one.rect["width"] for one in browser.deep("img")]
    assert len(pictures) == 3
    assert min(pictures) > (0.8 if mobile else 0.2) * width


@pytest.mark.end_to_end
def test_it_says_when_the_watch_is_over(browser: Browser, shown: Shown) -> None:
    shown.advance(1)
    browser.open(shown.page.url)
    browser.wait(step_is(browser, 1))
    assert not browser.text("#lost")
    assert browser.complaints() == []
    shown.page.close()
    browser.wait(lambda: "No connection" in browser.text("#lost"))


@pytest.mark.end_to_end
def test_the_token_is_typed_in_once(browser: Browser, tmp_path: Path) -> None:
    site = lego()
    content = Content(surveillance_model(site, 1), "pomdp", WatchState(site, tmp_path), False, True, False)
    with LivePage(content, token="sixteen letters or more") as page:
        browser.open(page.url)
        browser.deep("input")[0].send_keys("sixteen letters or more\n")
        browser.wait(lambda: "Waiting for the first step." in browser.text(".waiting"))
        assert browser.run("return location.pathname + location.search") == "/"
        assert browser.run("return document.cookie") == ""  # scripts cannot read it
        assert browser.complaints() == []
        browser.open("about:blank")
        browser.complaints()
