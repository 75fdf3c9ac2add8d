"""Layers of statements against an array that is filled statement by statement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from factored_pomdp.errors import TooLarge
from factored_pomdp.files.layers import Layers

SHAPE = (2, 3, 3)


@st.composite
def statements(draw: st.DrawFn) -> list[tuple]:
    """Boxes with one number, numbers along some free axes, or a diagonal; some of the numbers zero."""
    numbers = st.sampled_from([0.0, 0.0, 1.0, -2.5, 0.25])
    said = []
    for _ in range(draw(st.integers(0, 8))):
        coordinates = [draw(st.integers(-1, size - 1)) for size in SHAPE]
        free = [axis for axis, position in enumerate(coordinates) if position < 0]
        along = [axis for axis in free if draw(st.booleans())]
        if free == along == [1, 2] and draw(st.booleans()):
            said.append((coordinates, along, None))
        else:
            size = int(np.prod([SHAPE[axis] for axis in along]))
            said.append((coordinates, along, np.array([draw(numbers) for _ in range(size)])))
    return said


def plain(said: list[tuple]) -> np.ndarray:
    """The same, written into an array in order."""
    array = np.zeros(SHAPE)
    for coordinates, along, numbers in said:
        box = array[tuple(slice(None) if position < 0 else slice(position, position + 1) for position in coordinates)]
        if numbers is None:
            box[...] = np.eye(3)
        else:
            box[...] = numbers.reshape([SHAPE[axis] if axis in along else 1 for axis in range(3)])
    return array


def filled(said: list[tuple]) -> Layers:
    """The statements as layers."""
    layers = Layers(SHAPE)
    for stamp, (coordinates, along, numbers) in enumerate(said):
        if numbers is None:
            layers.diagonal(coordinates, tuple(along), stamp)
        elif along:
            layers.array(coordinates, along, numbers, stamp)
        elif stamp % 2:
            layers.scalars(np.array([coordinates]), numbers, np.array([stamp]))
        else:
            layers.scalar(coordinates, float(numbers[0]), stamp)
    return layers


@pytest.mark.property
@given(statements(), st.sets(st.integers(0, 2)))
def test_layers_are_what_filling_an_array_gives(said: list[tuple], keep: set[int]) -> None:
    entries = filled(said).entries(sorted(keep))
    found = np.zeros([SHAPE[axis] for axis in entries.axes])
    found[tuple(entries.coordinates.T)] = entries.numbers if entries.axes else entries.numbers.sum()
    for axis in sorted(set(range(3)) - set(entries.axes)):
        found = np.repeat(np.expand_dims(found, axis), SHAPE[axis], axis=axis)
    np.testing.assert_array_equal(found, plain(said))
    assert keep <= set(entries.axes)
    assert (entries.numbers != 0).all()


@pytest.mark.example
def test_axes_on_which_nothing_depends_are_left_out() -> None:
    layers = Layers([1_000_000, 1_000_000, 2])
    layers.scalar([-1, -1, 0], 0.75, 0)
    layers.scalar([-1, -1, 1], 0.25, 1)
    entries = layers.entries()
    assert entries.axes == (2,)
    assert entries.numbers.tolist() == [0.75, 0.25]
    assert entries.stamps.tolist() == [0, 1]


@pytest.mark.example
def test_zeros_over_everything_are_not_laid_out() -> None:
    layers = Layers([1_000, 1_000_000, 1_000_000])
    layers.scalar([3, 4, 5], 1.0, 0)
    layers.scalar([-1, -1, -1], 0.0, 1)
    layers.scalar([7, 8, 9], 0.5, 2)
    entries = layers.entries()
    assert entries.coordinates.tolist() == [[7, 8, 9]]


@pytest.mark.example
def test_too_many_entries_are_refused_before_they_are_made() -> None:
    layers = Layers([1_000, 1_000_000, 1_000_000])
    layers.scalar([0, 0, 0], 0.0, 0)
    layers.scalar([-1, -1, -1], 0.5, 1)
    with pytest.raises(TooLarge, match="1,000,000,000,000,000 entries or more"):
        layers.entries()
    with pytest.raises(TooLarge, match="a table of 10000000000 × 10000000000 places"):
        Layers([10**10, 10**10])
