"""Cassandra's grammar, form by form, with the numbers worked out by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp

HEAD = "discount: 0.9\nvalues: reward\nstates: a b c\nactions: go stay\nobservations: x y\n"
MOVES = "T: * identity\n"
VIEWS = "O: * uniform\n"


def read(tmp_path: Path, text: str) -> fp.FactoredPOMDP:
    path = tmp_path / "given.pomdp"
    path.write_text(text)
    return fp.load(path)


def moves(model: fp.FactoredPOMDP) -> np.ndarray:
    (action,), (state,) = model.actions, model.states
    scope = (action, state, state.next)
    return np.broadcast_to(model.transition["state"].array_over(scope), [v.size for v in scope])


def views(model: fp.FactoredPOMDP) -> np.ndarray:
    scope = (*model.actions, model.states[0].next, *model.observations)
    return np.broadcast_to(model.observation["observation"].array_over(scope), [v.size for v in scope])


def rewards(model: fp.FactoredPOMDP) -> np.ndarray:
    scope = (*model.actions, *model.states, model.states[0].next, *model.observations)
    return np.broadcast_to(model.reward["reward"].array_over(scope), [v.size for v in scope])


def start(model: fp.FactoredPOMDP) -> list[float]:
    return model.initial["state"].dense().array.tolist()


@pytest.mark.example
def test_names_and_what_every_part_is_called(tmp_path: Path) -> None:
    model = read(tmp_path, HEAD + MOVES + VIEWS)
    assert model.name == "given"
    assert model.discount == 0.9
    assert [v.name for v in (*model.states, *model.actions, *model.observations)] == ["state", "action", "observation"]
    assert model.states[0].values == ("a", "b", "c")
    assert model.transition["state"].names == ("state", "state.next")
    assert model.observation["observation"].names == ("observation",)
    assert model.reward["reward"].names == ()
    assert start(model) == pytest.approx([1 / 3] * 3)


@pytest.mark.example
def test_counted_values_are_named_by_their_number(tmp_path: Path) -> None:
    text = "observations : 2 actions:1\nstates: 2 discount: .5\nT:0\n0 1\n1 0\nO: 0 : 1 : 1 1\nO:0:0:0 1\nR:0:0:*:* -3"
    model = read(tmp_path, text)
    assert [v.values for v in (*model.states, *model.actions, *model.observations)] == [("0", "1"), ("0",), ("0", "1")]
    assert moves(model).tolist() == [[[0, 1], [1, 0]]]
    assert views(model).tolist() == [[[1, 0], [0, 1]]]
    assert model.discount == 0.5
    assert rewards(model)[0, :, 0, 0].tolist() == [-3, 0]


@pytest.mark.example
def test_named_values_may_be_meant_by_number(tmp_path: Path) -> None:
    model = read(tmp_path, HEAD + "T: 0 : 2 : 0 1\nT: go : a : 1 1\nT: go : b : b 1\nT: stay identity\n" + VIEWS)
    assert moves(model)[0].tolist() == [[0, 1, 0], [0, 1, 0], [1, 0, 0]]


@pytest.mark.example
def test_transitions_in_entry_row_and_matrix_form(tmp_path: Path) -> None:
    text = """
    T: go          # a matrix, broken anywhere
      0 1 0  0
      0 1
      1 0 0
    T: stay : *    # a row for every state
    .5 +0.25 2.5e-1
    T: stay : b : b 0.5
    T: stay : b : c
    0.0
    """
    assert moves(read(tmp_path, HEAD + text + VIEWS)).tolist() == [
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        [[0.5, 0.25, 0.25], [0.5, 0.5, 0], [0.5, 0.25, 0.25]],
    ]


@pytest.mark.example
def test_uniform_identity_and_reset(tmp_path: Path) -> None:
    text = "start: 0.5 0.5 0\nT: go identity\nT: go : b uniform\nT: go : c reset\nT: stay uniform\nO: go uniform\n"
    text += "O: stay : * uniform\nO: stay : a\n0.25 0.75\n"
    model = read(tmp_path, HEAD + text)
    third = 1 / 3
    assert moves(model)[0].tolist() == [[1, 0, 0], [third, third, third], [0.5, 0.5, 0]]
    np.testing.assert_allclose(moves(model)[1], third)
    assert views(model).tolist() == [[[0.5, 0.5]] * 3, [[0.25, 0.75], [0.5, 0.5], [0.5, 0.5]]]


@pytest.mark.example
def test_later_statements_hold_over_earlier_ones(tmp_path: Path) -> None:
    text = (
        "T: * : * : * 0.0\nT: * : * : a 1.0\nT: go : b : a 0\nT: go : b : c 1\nT: stay : c : a 0.5\nT: stay identity\n"
    )
    assert moves(read(tmp_path, HEAD + text + VIEWS)).tolist() == [
        [[1, 0, 0], [0, 0, 1], [1, 0, 0]],
        np.eye(3).tolist(),
    ]


@pytest.mark.example
@pytest.mark.parametrize(
    ("said", "belief"),
    [
        ("start: 0.25 0.5 0.25", [0.25, 0.5, 0.25]),
        ("start: uniform", [1 / 3, 1 / 3, 1 / 3]),
        ("start: b", [0, 1, 0]),
        ("start: 2", [0, 0, 1]),
        ("start include: a c", [0.5, 0, 0.5]),
        ("start exclude: a", [0, 0.5, 0.5]),
        ("start exclude : 0 c", [0, 1, 0]),
    ],
)
def test_every_form_of_start(tmp_path: Path, said: str, belief: list[float]) -> None:
    assert start(read(tmp_path, f"{HEAD}{said}\n{MOVES}{VIEWS}")) == pytest.approx(belief)
    assert start(read(tmp_path, f"{HEAD}{MOVES}{VIEWS}{said}\n")) == pytest.approx(belief)


@pytest.mark.example
def test_start_of_a_single_state(tmp_path: Path) -> None:
    head = "discount: 1\nstates: 1\nactions: 1\nobservations: 1\n"
    for said in ("start: 1.0", "start: 1", "start: 0", "start: uniform"):
        assert start(read(tmp_path, f"{head}{said}\n{MOVES}{VIEWS}")) == [1.0]
    with pytest.raises(fp.FileError, match=r"line 5: start: found probabilities that sum to 0\.5; expected sum 1"):
        read(tmp_path, f"{head}start: 0.5\n{MOVES}{VIEWS}")


@pytest.mark.example
def test_rewards_in_all_forms_of_any_end_and_observation(tmp_path: Path) -> None:
    text = """
    R: * : * : * : * -1
    R: go : a : b : x 7
    R: go : b : c
    1 2
    R: stay : c
    10 11
    20 21
    30 31
    R: stay : c : b : * 5
    """
    found = rewards(read(tmp_path, HEAD + MOVES + VIEWS + text))
    expected = np.full((2, 3, 3, 2), -1.0)
    expected[0, 0, 1, 0] = 7
    expected[0, 1, 2] = [1, 2]
    expected[1, 2] = [[10, 11], [5, 5], [30, 31]]
    assert found.tolist() == expected.tolist()


@pytest.mark.example
def test_costs_are_negative_rewards(tmp_path: Path) -> None:
    head = HEAD.replace("values: reward", "values: cost")
    model = read(tmp_path, head + MOVES + VIEWS + "R: go : a : * : * 4\nR: stay : * : * : * -0.5\n")
    assert rewards(model)[:, :, 0, 0].tolist() == [[-4, 0, 0], [0.5, 0.5, 0.5]]


@pytest.mark.example
def test_words_may_touch_colons_and_signs_stand_apart(tmp_path: Path) -> None:
    model = read(tmp_path, HEAD + "T:go:*:a 1\nT :stay: * :a 1\n" + VIEWS + "R:go:*:*:* - 2.5\nR:stay:*:*:* + .5\n")
    assert moves(model)[:, :, 0].tolist() == [[1, 1, 1], [1, 1, 1]]
    assert rewards(model)[:, 0, 0, 0].tolist() == [-2.5, 0.5]


@pytest.mark.example
def test_values_may_be_called_like_keywords(tmp_path: Path) -> None:
    head = "discount: 1\nstates: T R start\nactions: O states\nobservations: R include\nstart include: T start\n"
    model = read(
        tmp_path, head + "T: O : T : R 1\nT: O : R : T 1\nT: O : start : start 1\nT: states identity\n" + VIEWS
    )
    assert moves(model)[0].tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
    assert start(model) == [0.5, 0, 0.5]


@pytest.mark.example
def test_rows_that_nearly_sum_to_one_are_renormalised_with_a_note(tmp_path: Path) -> None:
    model = read(tmp_path, HEAD + MOVES + "T: go : b\n0.333333 0.333333 0.333333\n" + VIEWS)
    assert moves(model)[0, 1].tolist() == [1 / 3, 1 / 3, 1 / 3]
    (note,) = model.notes
    assert "1 of 6 distributions renormalised (worst sum 0.999999 at action=go, state=b)" in note


@pytest.mark.example
def test_markov_decision_process_with_a_certain_start_knows_its_state(tmp_path: Path) -> None:
    head = "discount: 0.9\nstates: a b c\nactions: go stay\nstart: b\n"
    model = read(tmp_path, head + MOVES + "R: go : a : b 2\nR: go : b : *  3\nR: stay : c\n4\n5\n6\n")
    assert model.observations == ()
    assert model.declared_known == {"state"}
    expected = np.zeros((2, 3, 3))
    expected[0, 0, 1], expected[0, 1], expected[1, 2] = 2, 3, [4, 5, 6]
    assert rewards(model).tolist() == expected.tolist()


@pytest.mark.example
def test_markov_decision_process_with_an_uncertain_start_observes_its_state(tmp_path: Path) -> None:
    model = read(tmp_path, "discount: 0.9\nstates: a b c\nactions: go stay\n" + MOVES)
    assert model.declared_known == set()
    assert views(model).tolist() == [np.eye(3).tolist()] * 2
    assert model.notes == (
        "no observations in the file: after every step the state is observed (not before the first)",
    )
