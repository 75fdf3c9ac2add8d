"""What is written and read again is the same model: random models, and by hand where a format changes the form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from factored_pomdp.files.flatten import read_back
from tests.strategies import random_models

EXACT = 1e-12


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("models")


def again(model: fp.FactoredPOMDP, path: Path) -> fp.FactoredPOMDP:
    fp.save(model, path)
    return fp.load(path)


def without_legal(model: fp.FactoredPOMDP) -> fp.FactoredPOMDP:
    """The same model where everything is legal: no file can say which actions are."""
    kinds = ("states", "actions", "observations", "transition", "observation", "reward", "initial", "discount", "name")
    return fp.FactoredPOMDP(**{kind: getattr(model, kind) for kind in kinds}, known=model.declared_known)


def same(one: fp.FactoredPOMDP, other: fp.FactoredPOMDP) -> None:
    """Same variables (values as they print), and the same numbers in every factor."""
    for kind in ("states", "actions", "observations"):
        for variable, twin in zip(getattr(one, kind), getattr(other, kind), strict=True):
            assert (variable.name, [str(v) for v in variable.values]) == (twin.name, [str(v) for v in twin.values])
    assert one.discount == other.discount
    assert one.declared_known == other.declared_known
    for kind in ("initial", "transition", "observation", "reward"):
        assert list(getattr(one, kind)) == list(getattr(other, kind))
        for name, factor in getattr(one, kind).items():
            twin = getattr(other, kind)[name]
            assert set(twin.names) <= set(factor.names)
            scope = [other.variable(variable.name) for variable in factor.scope]
            array = np.broadcast_to(twin.array_over(scope), [variable.size for variable in scope])
            np.testing.assert_allclose(array, factor.array_over(factor.scope), rtol=0, atol=EXACT)


@pytest.mark.property
@settings(max_examples=30)
@given(random_models())
def test_pomdpx_keeps_every_factor(folder: Path, model: fp.FactoredPOMDP) -> None:
    written = without_legal(model)
    loaded = again(written, folder / "factored.pomdpx")
    same(written, loaded)
    same(loaded, again(loaded, folder / "twice.pomdpx"))


@pytest.mark.property
@settings(max_examples=30)
@given(random_models(most_states=3))
def test_pomdp_is_the_joint_model(folder: Path, model: fp.FactoredPOMDP) -> None:
    written = without_legal(model)
    loaded = again(written, folder / "flat.pomdp")
    one, other = fp.joint(written), fp.joint(loaded)
    np.testing.assert_allclose(other.initial, one.initial, atol=EXACT)
    np.testing.assert_allclose(other.reward, one.reward, atol=1e-11)
    also = int(np.prod([variable.size for variable in read_back(written)], dtype=int))
    for action, matrix in enumerate(one.transition):
        np.testing.assert_allclose(other.transition[action].toarray(), matrix.toarray(), atol=EXACT)
        seen = other.observation[action].toarray().reshape(written.joint_states, -1, also)
        np.testing.assert_allclose(seen.sum(axis=2), one.observation[action].toarray(), atol=EXACT)
        assert ((seen > 0).any(axis=1).sum(axis=1) == 1).all()
    same(loaded, again(loaded, folder / "twice.pomdp"))


@pytest.mark.property
@settings(max_examples=15)
@given(random_models(most_states=2))
def test_flat_models_go_through_either_format(folder: Path, model: fp.FactoredPOMDP) -> None:
    flat = again(without_legal(model), folder / "first.pomdp")
    there = again(flat, folder / "there.pomdpx")
    same(flat, there)
    same(flat, again(there, folder / "back.pomdp"))


@pytest.mark.example
def test_known_variables_that_chance_moves_become_part_of_the_observation(tmp_path: Path) -> None:
    hidden, coin, act = fp.Variable("hidden", "ab"), fp.Variable("coin", ["head", "tail"]), fp.Variable("act", ["go"])
    seen = fp.Variable("seen", ["yes", "no"])
    model = fp.FactoredPOMDP(
        states=[hidden, coin],
        actions=[act],
        observations=[seen],
        transition={"hidden": lambda hidden: hidden, "coin": lambda coin: {"head": 0.25, "tail": 0.75}},
        observation={"seen": lambda hidden_next: {"yes": 0.9, "no": 0.1} if hidden_next == "a" else "no"},
        reward=1.0,
        initial={"hidden": [0.5, 0.5], "coin": "head"},
        known=["coin"],
    )
    loaded = again(model, tmp_path / "coin.pomdp")
    assert loaded.states[0].values == ("a_head", "a_tail", "b_head", "b_tail")
    assert loaded.observations[0].values == ("yes_head", "yes_tail", "no_head", "no_tail")
    assert fp.joint(loaded).observation[0].toarray().tolist() == [
        [0.9, 0, 0.1, 0],
        [0, 0.9, 0, 0.1],
        [0, 0, 1, 0],
        [0, 0, 0, 1],
    ]


@pytest.mark.example
def test_terminal_states_are_absorbing_in_a_flat_file_and_refused_in_a_factored_one(tmp_path: Path) -> None:
    place, act = fp.Variable("place", ["on", "off"]), fp.Variable("act", ["wait"])
    model = fp.FactoredPOMDP(
        states=[place],
        actions=[act],
        observations=[],
        transition={"place": lambda place: {"on": 0.5, "off": 0.5}},
        observation={},
        reward=2.0,
        initial={"place": "on"},
        terminal={"off": True},
    )
    loaded = again(model, tmp_path / "ends.pomdp")
    assert fp.joint(loaded).transition[0].toarray().tolist() == [[0.5, 0.5], [0, 1]]
    assert fp.joint(loaded).reward.tolist() == [[2, 0]]
    with pytest.raises(ValueError, match="cannot say which states are terminal"):
        fp.save(model, tmp_path / "ends.pomdpx")


@pytest.mark.example
def test_values_that_are_no_words_get_words(tmp_path: Path) -> None:
    cell = fp.Variable("cell", [(0, 0), (0, 1), "uniform", "a b"])
    act, heard = fp.Variable("act", [-1, 1]), fp.Variable("heard", [True, False])
    model = fp.FactoredPOMDP(
        states=[cell],
        actions=[act],
        observations=[heard],
        transition={"cell": lambda cell: cell},
        observation={"heard": lambda act: act > 0},
        reward=fp.table("cell", values=[1.0, 2.0, 3.0, 4.0]),
        initial={"cell": (0, 1)},
    )
    loaded = again(model, tmp_path / "words.pomdp")
    assert loaded.states[0].values == ("c0_0", "c0_1", "uniform_", "a_b")
    assert loaded.actions[0].values == ("a-1", "a1")
    assert loaded.observations[0].values == ("True", "False")
    assert loaded.initial["state"].dense().array.tolist() == [0, 1, 0, 0]
    factored = again(model, tmp_path / "words.pomdpx")
    assert factored.states[0].values == ("(0,_0)", "(0,_1)", "uniform", "a_b")
    assert factored.reward["reward"].dense().array.tolist() == [1, 2, 3, 4]


@pytest.mark.example
def test_what_a_file_cannot_say_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    surveillance = fp.domain("surveillance", site="hall", targets=2)
    with pytest.raises(fp.TooLarge, match=r"joint states; a \.pomdp file may have 500,000"):
        fp.save(surveillance, tmp_path / "hall.pomdp")
    tiger = fp.domain("tiger")
    (side,), (act,) = tiger.states, tiger.actions
    parts = {kind: getattr(tiger, kind) for kind in ("transition", "observation", "reward", "initial", "observations")}
    start = parts["initial"] | {side.name: side.values[0]}
    model = fp.FactoredPOMDP(
        **parts | {"initial": start},
        states=[side],
        actions=[act],
        known=[side.name],
        legal={act.name: fp.table(side.name, act.name, values=np.ones((2, 3)))},
    )
    for ending in (".pomdp", ".pomdpx"):
        with pytest.raises(ValueError, match="cannot say which actions are legal"):
            fp.save(model, tmp_path / f"tiger{ending}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.example
def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "tiger.pomdp"
    fp.save(fp.domain("tiger"), path)
    before = path.read_text()
    monkeypatch.setattr("factored_pomdp.files.cassandra.writer._table", lambda *_: iter([None]))
    with pytest.raises(TypeError):
        fp.save(fp.domain("tiger"), path)
    assert path.read_text() == before
    assert list(tmp_path.iterdir()) == [path]
