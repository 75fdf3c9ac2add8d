"""Answers of real AXIS cameras, and of anything else."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras import answers
from surveillance_domain.cameras.base import Limits, Position
from surveillance_domain.cameras.errors import BadAnswer, CameraError, Refused

SHARED = Path(__file__).parents[3] / ".." / "shared" / "data" / "camera" / "vapix.md"

lines = st.lists(
    st.tuples(
        st.sampled_from(["pan", "tilt", "zoom", "MinPan", "MaxPan", "MinZoom", "MaxZoom", "image width", "Error:", ""]),
        st.sampled_from(["=", "", " = ", "=="]),
        st.one_of(
            st.floats().map(str), st.integers().map(str), st.text(max_size=8), st.sampled_from(["0.0", "1e999", "٣"])
        ),
    ),
    max_size=8,
).map(lambda rows: "\r\n".join("".join(row) for row in rows))


@pytest.fixture(scope="module")
def recorded() -> list[str]:
    """The blocks of answers in the collection of what cameras answer: limits, position."""
    if not SHARED.is_file():
        pytest.skip("the collection of camera answers is not beside the repository")
    return [block.strip("\n") for block in SHARED.read_text(encoding="utf-8").split("```")[1::2]]


@pytest.mark.example
def test_recorded_limits_and_position(recorded: list[str]) -> None:
    limits, position = recorded[:2]
    assert answers.limits(limits) == Limits((-170.0, 170.0), (-20.0, 90.0), (1.0, 9999.0))
    assert answers.position(position) == Position(51.2891, 46.1914, 1.0)


@pytest.mark.example
def test_keys_may_be_missing_and_zero_is_a_value() -> None:
    assert answers.position("pan=0.0\r\ntilt=-0\r\n") == Position(0.0, 0.0, None)
    assert answers.limits("MinPan=-180\nMaxPan=180\nMinTilt=-90\n") == Limits(pan=(-180.0, 180.0))
    assert answers.key_values("PTZ list\n\nroot.PTZ.A=b=c\n=x\n") == {"root.PTZ.A": "b=c"}


@pytest.mark.example
@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("Error:\nquery: unknown value: X", "query: unknown value: X"),
        ("\r\nerror: nothing\r\n", "nothing"),
        ("Error", "Error"),
        ("<!--Camera 1 not available.-->", "Camera 1 not available."),
    ],
)
def test_refusals_are_read_whatever_the_status(body: str, reason: str) -> None:
    with pytest.raises(Refused, match=f"refuses: {reason}$"):
        answers.position(body)
    with pytest.raises(Refused):
        answers.image_size(body)


@pytest.mark.example
@pytest.mark.parametrize(
    "body", ["", "pan=1", "pan=x\ntilt=1", "pan=nan\ntilt=1", "pan=1e999\ntilt=0", "<html></html>"]
)
def test_no_position(body: str) -> None:
    with pytest.raises(BadAnswer, match="expected"):
        answers.position(body)


@pytest.mark.example
def test_limits_that_are_none() -> None:
    with pytest.raises(BadAnswer, match="MinPan=-170"):
        answers.limits("hello")
    with pytest.raises(BadAnswer, match="found 5 to -5"):
        answers.limits("MinPan=5\nMaxPan=-5")


@pytest.mark.example
def test_sizes_and_zoom_steps() -> None:
    assert answers.image_size("image width = 768\r\nimage height = 576\r\n") == (768, 576)
    with pytest.raises(BadAnswer):
        answers.image_size("image width = 0\nimage height = 576")
    expected = ((1, 1), (3868, 2), (7736, 3), (9999, 3.585))
    for text in ("{1,1},{3868,2},{7736,3},{9999,3.585}", "1:1 3868:2 7736:3 9999:3.585"):
        assert answers.zoom_steps({"zoomSteps": text}) == expected
    assert answers.zoom_steps({}) == ()


@pytest.mark.property
@given(st.one_of(lines, st.text(), st.binary().map(lambda raw: raw.decode("utf-8", errors="replace"))))
def test_any_text_is_read_or_refused_in_our_own_words(body: str) -> None:
    for parse in (answers.position, answers.limits, answers.image_size, answers.key_values):
        with suppress(CameraError):
            assert parse(body) is not None


@pytest.mark.property
@given(st.floats(-400, 400), st.floats(-90, 90), st.one_of(st.none(), st.floats(1, 9999)))
def test_what_is_written_is_read(pan: float, tilt: float, zoom: float | None) -> None:
    body = f"pan={pan!r}\ntilt={tilt!r}\n" + ("" if zoom is None else f"zoom={zoom!r}\n")
    assert answers.position(body) == Position(pan, tilt, zoom)
