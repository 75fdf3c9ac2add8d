"""A base and differences from it against the table that they stand for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.files import layers, sums
from factored_pomdp.files.cassandra.reader import read_cassandra
from factored_pomdp.files.defaults import Piece, as_terms, cheapest_base, looked_up
from factored_pomdp.files.layers import Layers
from tests.factored_pomdp.files.test_layers import SHAPE, filled, plain, statements

ACTIONS, STATES, SEEN = "ab", "xyz", "no"
SIZES = [len(ACTIONS), len(STATES), len(STATES), len(SEEN)]
HEAD = (
    f"discount: 0.9\nstates: {' '.join(STATES)}\nactions: {' '.join(ACTIONS)}\nobservations: {' '.join(SEEN)}\n"
    "T: * identity\nO: * uniform\n"
)
Said = tuple[list[int], list[float]]


@pytest.mark.property
@given(statements())
def test_base_and_differences_sum_to_the_table(said: list[tuple]) -> None:
    base, differences = filled(said).base_and_differences()
    total = np.zeros(SHAPE)
    for entries in (base, differences):
        found = np.zeros([SHAPE[axis] if axis in entries.axes else 1 for axis in range(len(SHAPE))])
        at = [np.zeros(len(entries.numbers), dtype=int)] * len(SHAPE)
        for column, axis in enumerate(entries.axes):
            at[axis] = entries.coordinates[:, column]
        np.add.at(found, tuple(at), entries.numbers)
        total += found
        assert (entries.numbers != 0).all()
        assert len(np.unique(entries.coordinates, axis=0)) == len(entries.numbers)
    np.testing.assert_allclose(total, plain(said), rtol=0, atol=1e-12)


@pytest.mark.example
def test_a_default_and_its_exceptions_over_a_hundred_billion_places() -> None:
    made = Layers([10, 10_000, 10_000, 100])
    made.scalar([-1, 7, 8, 1], 5.0, 0)
    made.scalar([-1, -1, -1, -1], -1.0, 1)
    made.scalar([3, -1, -1, -1], -2.0, 2)
    made.scalar([-1, 4, 5, -1], 0.0, 3)
    made.scalar([3, 6, 6, -1], -2.0, 4)
    made.scalar([2, 9, 9, -1], 10.0, 5)
    base, differences = made.base_and_differences()
    assert base.axes == (0,)
    assert base.numbers.tolist() == [-1, -1, -1, -2, -1, -1, -1, -1, -1, -1]
    assert base.stamps.tolist() == [1, 1, 1, 2, 1, 1, 1, 1, 1, 1]
    assert differences.axes == (0, 1, 2)
    places = differences.coordinates.tolist()
    assert places == [[0, 4, 5], [1, 4, 5], [2, 4, 5], [2, 9, 9], *([action, 4, 5] for action in range(3, 10))]
    assert differences.numbers.tolist() == [1, 1, 1, 11, 2, 1, 1, 1, 1, 1, 1]


@pytest.mark.example
def test_a_number_for_each_value_may_be_the_base() -> None:
    made = Layers([2, 50, 50])
    made.array([-1, -1, -1], (1,), np.arange(50.0), 0)
    made.scalar([-1, -1, 7], 3.0, 1)
    base, differences = made.base_and_differences()
    assert base.axes == (1,)
    assert base.numbers.tolist() == list(range(1, 50))
    assert differences.axes == (1, 2)
    assert differences.coordinates.tolist() == [[value, 7] for value in range(50) if value != 3]
    assert differences.numbers.tolist() == [3.0 - value for value in range(50) if value != 3]


@pytest.mark.example
def test_the_base_is_chosen_for_the_fewest_entries() -> None:
    shape = [5, 3_000, 3_000]
    default, exceptions = Piece(0b000, 1, 1), Piece(0b111, 10, 10)
    assert cheapest_base([default, exceptions], shape) == (0b000, 11)
    assert cheapest_base([default, exceptions, Piece(0b001, 2, 2)], shape) == (0b001, 5 + 10)
    assert cheapest_base([Piece(0b010, 3_000, 3_000), Piece(0b100, 2, 2)], shape) == (0b010, 3_000 + 2 * 3_000)
    assert cheapest_base([], shape) == (0, 0)


@pytest.mark.example
def test_numbers_are_looked_up_by_key() -> None:
    keys, numbers = np.array([2, 5, 9]), np.array([0.5, -1.0, 3.0])
    assert looked_up(keys, numbers, np.array([9, 0, 5, 12, 2])).tolist() == [3.0, 0.0, -1.0, 0.0, 0.5]
    assert looked_up(keys[:0], numbers[:0], np.array([1, 2])).tolist() == [0.0, 0.0]


@pytest.mark.example
def test_the_exceptions_get_a_name_that_no_other_reward_has() -> None:
    parts = [fp.factors.constant(number) for number in (1.0, 2.0)]
    assert list(as_terms("cost", parts[:1])) == ["cost"]
    assert list(as_terms("cost", parts)) == ["cost", "cost_exceptions"]
    assert list(as_terms("cost", parts, {"cost", "cost_exceptions"})) == ["cost", "cost_exceptions_"]


@st.composite
def rewards(draw: st.DrawFn) -> list[Said]:
    """Statements: names of 2 to 4 places (-1: all), and the numbers along those that are not named."""
    said = []
    for _ in range(draw(st.integers(1, 7))):
        named = draw(st.sampled_from([4, 4, 4, 3, 2]))
        places = [draw(st.sampled_from([-1, *range(size)])) for size in SIZES[:named]]
        number = st.sampled_from([0.0, -1.0, 10.0, 0.1, 0.3])
        count = int(np.prod(SIZES[named:], dtype=int))
        said.append((places, draw(st.lists(number, min_size=count, max_size=count))))
    return said


def written(said: list[Said]) -> str:
    names = [ACTIONS, STATES, STATES, SEEN]
    lines = []
    for places, numbers in said:
        words = ["*" if place < 0 else listed[place] for place, listed in zip(places, names, strict=False)]
        lines.append(f"R: {' : '.join(words)} {' '.join(map(str, numbers))}\n")
    return HEAD + "".join(lines)


def literal(said: list[Said]) -> np.ndarray:
    """The statements, carried out in order."""
    array = np.zeros(SIZES)
    for places, numbers in said:
        box = tuple(slice(None) if place < 0 else slice(place, place + 1) for place in places)
        array[box] = np.reshape(numbers, SIZES[len(places) :])
    return array


def total(model: fp.FactoredPOMDP) -> np.ndarray:
    scope = [model.actions[0], model.states[0], model.states[0].next, model.observations[0]]
    return sum((factor.array_over(scope) for factor in model.reward.values()), np.zeros(SIZES))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("defaults")


@pytest.mark.property
@settings(max_examples=70)
@given(rewards(), st.integers(6, 20))
@example([([-1, -1, -1, -1], [-1.0]), ([0, 1, 2, -1], [10.0]), ([-1, 0, 0, 0], [0.0])], 6)
@example([([0, -1, -1, -1], [-1.0]), ([-1, -1, -1, 1], [0.3]), ([1, 2], [0.0, 1, 0, 2, 0, 0])], 12)
def test_files_whose_reward_would_be_too_large_as_one_table(folder: Path, said: list[Said], most: int) -> None:
    (folder / "given.pomdp").write_text(written(said))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(layers, "MOST_ENTRIES", most)
        patch.setattr(sums, "_MOST_PLACES", 0)
        try:
            model = read_cassandra(folder / "given.pomdp")
        except fp.FileError:
            event("refused")
            return
        event(f"{len(model.reward)} terms")
        np.testing.assert_allclose(total(model), literal(said), rtol=0, atol=1e-12)
        assert sum(factor.sparse().stored for factor in model.reward.values()) <= most
        assert set(model.reward) <= {"reward", "reward_exceptions"}
        for name in ("again.pomdp", "again.pomdpx"):
            fp.save(model, folder / name)
            np.testing.assert_allclose(total(fp.load(folder / name)), literal(said), rtol=0, atol=1e-12)


@pytest.mark.example
def test_costs_with_a_default_and_exceptions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layers, "MOST_ENTRIES", 12)
    text = written([([-1, -1, -1, -1], [2.0]), ([0, 1, 2, -1], [7.0]), ([-1, 0, 0, -1], [0.0])])
    (tmp_path / "costs.pomdp").write_text("values: cost\n" + text)
    model = read_cassandra(tmp_path / "costs.pomdp")
    assert model.reward["reward"].names == ()
    assert model.reward["reward"].dense().array.tolist() == -2
    differences = model.reward["reward_exceptions"]
    assert differences.names == ("action", "state", "state.next")
    assert differences.value({"action": "a", "state": "y", "state.next": "z"}) == -5
    assert differences.value({"action": "b", "state": "x", "state.next": "x"}) == 2
    assert differences.sparse().stored == 3
