"""Which marker and which colour a target bears."""

from __future__ import annotations

from dataclasses import replace

import pytest

from surveillance_domain.model.looks import Look, looks
from surveillance_domain.site.load import load_site


@pytest.mark.example
def test_lego_robots_are_named_for_their_colours() -> None:
    assert looks(load_site("lego"), 3) == (
        Look("red", 0, (255, 0, 0)),
        Look("blue", 1, (0, 0, 255)),
        Look("green", 2, (0, 128, 0)),
    )


@pytest.mark.example
def test_targets_that_the_site_does_not_name_get_markers_that_are_left() -> None:
    many = looks(load_site("lego"), 9)
    assert [look.marker for look in many] == list(range(9))
    assert len({look.colour for look in many}) == 9
    assert [look.marker for look in looks(load_site("hall"), 3)] == [None] * 3


@pytest.mark.example
def test_a_colour_that_the_site_gives_comes_before_that_of_the_name() -> None:
    lego = load_site("lego")
    red = lego.targets.known[0].model_copy(update={"color": "#ff8000"})
    site = replace(lego, targets=lego.targets.model_copy(update={"known": (red, *lego.targets.known[1:])}))
    assert [look.colour for look in looks(site, 2)] == [(255, 128, 0), (0, 0, 255)]
