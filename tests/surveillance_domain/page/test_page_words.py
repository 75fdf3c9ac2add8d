"""The HTML of numbers, cameras and pictures."""

from __future__ import annotations

import pytest

from surveillance_domain.page.gallery import gallery
from surveillance_domain.page.headline import headline
from surveillance_domain.page.health import health_row, holder
from surveillance_domain.page.snapshot import Mark
from tests.page_snapshots import camera, picture, snapshot

EVIL = '<script>"&'
SAFE = "&lt;script&gt;&quot;&amp;"


@pytest.mark.example
def test_the_headline_has_the_numbers_of_the_step() -> None:
    shown = headline(snapshot(2400, time_s=3661.5, cameras=(camera("north"), camera("south", view=None))))
    for name, value in (
        ("step", "2,400"),
        ("since the start", "1:01:01"),
        ("PercentObs", "50.0 %"),
        ("seen now", "1 of 2"),
        ("expected", "1.20"),
        ("cameras with a view", "1 of 2"),
        ("decision", "2.0 ms"),
    ):
        assert f"<dt>{name}</dt><dd>{value}</dd>" in shown
    assert "late" not in shown


@pytest.mark.example
def test_the_headline_warns_of_a_step_that_is_overdue() -> None:
    assert "No step for 12 s." in headline(snapshot(), age_s=12.0, overdue_s=9.5)
    assert "No step" not in headline(snapshot(), age_s=9.0, overdue_s=9.5)


@pytest.mark.example
def test_the_headline_says_what_there_is_not() -> None:
    assert "Waiting for the first step." in headline(None)
    shown = headline(snapshot(percent_obs=None, expected=None))
    assert "<dt>PercentObs</dt><dd>no truth</dd>" in shown
    assert "<dt>expected</dt><dd>–</dd>" in shown


@pytest.mark.example
@pytest.mark.parametrize(
    ("state", "kind", "who"),
    [
        ("ready", "ready", ""),
        ("away", "away", ""),
        ("locked out", "away", ""),
        ("held", "taken", "hold or this page"),
        ("moved by somebody else", "taken", "somebody else"),
    ],
)
def test_a_row_tells_state_and_holder(state: str, kind: str, who: str) -> None:
    assert holder(state) == who
    row = health_row(camera("north", state=state, failures=3, because=state), "left", "#0072B2")
    assert f'<em class="{kind}">{state}</em>' in row
    assert ">3</span>" in row
    assert (f">{who}</span>" in row) if who else ('data-title="held by" class="none"' in row)


@pytest.mark.example
def test_names_and_reasons_are_text_not_html() -> None:
    row = health_row(camera(EVIL, because=EVIL), EVIL, "#0072B2")
    pictures = gallery([EVIL, "b" + EVIL], {EVIL: picture(marks=(Mark((1.0, 2.0), 3.0, EVIL),))}, 1)
    for shown in (row, pictures):
        assert "<script" not in shown
        assert shown.count(SAFE) >= 3


@pytest.mark.example
def test_an_old_picture_says_how_old_it_is() -> None:
    shown = gallery(["north", "south", "east"], {"north": picture(7), "south": picture(4)}, 7)
    now, old, none = shown.split("<figure ")[1:]
    assert now.startswith('class="now"')
    assert "north, step 7<" in now
    assert old.startswith('class="old"')
    assert "south, step 4, 3 steps ago" in old
    assert "east: no picture yet" in none
    assert 'src="data:image/jpeg;base64,/9j/"' in now
    assert 'viewBox="0 0 64 48"' in now
