"""POMDPX by hand: RockSample(3, 1) of the format's description as tables and as diagrams, and its special words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp

VARIABLES = """
  <StateVar vnamePrev="rover_0" vnameCurr="rover_1" fullyObs="true"><NumValues>3</NumValues></StateVar>
  <StateVar vnamePrev="rock_0" vnameCurr="rock_1"><ValueEnum>good bad</ValueEnum></StateVar>
  <ObsVar vname="sensor"><ValueEnum>ogood obad</ValueEnum></ObsVar>
  <ActionVar vname="act"><ValueEnum>west east check sample</ValueEnum></ActionVar>
  <RewardVar vname="the reward"/>
"""


def entries(table: str, *rows: str) -> str:
    listed = "".join(
        f"<Entry><Instance>{instance}</Instance><{table}>{numbers}</{table}></Entry>"
        for instance, numbers in (row.split("|") for row in rows)
    )
    return f"<Parameter>{listed}</Parameter>"


def function(tag: str, about: str, parents: str, parameter: str) -> str:
    return f"<{tag}><Var>{about}</Var><Parent>{parents}</Parent>{parameter}</{tag}>"


BELIEF = (
    function("CondProb", "rover_0", "null", entries("ProbTable", "-|0 1 0")),
    function("CondProb", "rock_0", "null", entries("ProbTable", "-|uniform")),
)
ROVER = function(
    "CondProb",
    "rover_1",
    "act rover_0",
    entries(
        "ProbTable",
        *("west s0 s2|1", "west s1 s0|1", "east s0 s1|1", "east s1 s2|1", "check - -|identity"),
        *("sample s0 s0|1", "sample s1 s2|1", "* s2 s2|1"),
    ),
)
ROCK = function(
    "CondProb",
    "rock_1",
    "act rover_0 rock_0",
    entries("ProbTable", "* * - -|identity", "west * - -|1 0 0 1", "sample s0 * -|0.0 1.0"),
)
SENSOR = function(
    "CondProb",
    "sensor",
    "act rover_1 rock_1",
    entries("ProbTable", "* * * -|1 0", "check s0 - -|1 0 0 1", "check s1 - -|.8 .2 .2 .8", "check s2 * -|1 0"),
)
REWARD = function(
    "Func",
    "the reward",
    "act rover_0 rock_0",
    entries("ValueTable", "east s1 *|10", "west s0 *|-100", "sample s1 *|-100", "sample s0 -|10 -10"),
)


def document(
    variables: str = VARIABLES,
    belief: tuple[str, ...] = BELIEF,
    moves: tuple[str, ...] = (ROVER, ROCK),
    views: tuple[str, ...] = (SENSOR,),
    rewards: tuple[str, ...] = (REWARD,),
) -> str:
    return (
        f"<?xml version='1.0'?>\n<pomdpx version='1.0' id='rock'><Description>by hand</Description>\n"
        f"<Discount>0.95</Discount>\n<Variable>{variables}</Variable>\n"
        f"<InitialStateBelief>{''.join(belief)}</InitialStateBelief>\n"
        f"<StateTransitionFunction>{''.join(moves)}</StateTransitionFunction>\n"
        f"<ObsFunction>{''.join(views)}</ObsFunction>\n<RewardFunction>{''.join(rewards)}</RewardFunction></pomdpx>"
    )


def read(tmp_path: Path, text: str) -> fp.FactoredPOMDP:
    path = tmp_path / "given.pomdpx"
    path.write_text(text)
    return fp.load(path)


def table(factor: fp.Factor, model: fp.FactoredPOMDP, *names: str) -> np.ndarray:
    scope = [model.variable(name) for name in names]
    return np.broadcast_to(factor.array_over(scope), [variable.size for variable in scope])


@pytest.mark.example
def test_tables_become_factors_as_they_are_written(tmp_path: Path) -> None:
    model = read(tmp_path, document())
    assert [variable.name for variable in model.states] == ["rover", "rock"]
    assert model.variable("rover").values == ("s0", "s1", "s2")
    assert model.declared_known == {"rover"}
    assert list(model.reward) == ["the reward"]
    assert model.discount == 0.95
    rover = table(model.transition["rover"], model, "act", "rover", "rover.next")
    assert rover.argmax(axis=2).tolist() == [[2, 0, 2], [1, 2, 2], [0, 1, 2], [0, 2, 2]]
    assert np.isin(rover, [0, 1]).all()
    rock = table(model.transition["rock"], model, "act", "rover", "rock", "rock.next")
    assert rock[3, 0].tolist() == [[0, 1], [0, 1]]
    assert rock[3, 1].tolist() == rock[0, 2].tolist() == [[1, 0], [0, 1]]
    sensor = table(model.observation["sensor"], model, "act", "rover.next", "rock.next", "sensor")
    assert sensor[2].tolist() == [[[1, 0], [0, 1]], [[0.8, 0.2], [0.2, 0.8]], [[1, 0], [1, 0]]]
    assert sensor[0, 1].tolist() == [[1, 0], [1, 0]]
    reward = table(model.reward["the reward"], model, "act", "rover", "rock")
    assert reward[3].tolist() == [[10, -10], [-100, -100], [0, 0]]
    assert reward[1].tolist() == [[0, 0], [10, 10], [0, 0]]
    assert model.initial["rock"].dense().array.tolist() == [0.5, 0.5]


def node(var: str, **edges: str) -> str:
    return (
        f'<Node var="{var}">' + "".join(f'<Edge val="{v}">{inside}</Edge>' for v, inside in edges.items()) + "</Node>"
    )


def end(number: float) -> str:
    return f"<Terminal>{number}</Terminal>"


def certain(var: str, val: str) -> str:
    return f'<SubDAG type="deterministic" var="{var}" val="{val}"/>'


def same(var: str) -> str:
    return f'<SubDAG type="persistent" var="{var}"/>'


def diagram(inside: str, *templates: str) -> str:
    return f'<Parameter type="DD"><DAG>{inside}</DAG>{"".join(templates)}</Parameter>'


def as_diagrams() -> dict[str, tuple[str, ...]]:
    """The same model, as the format's description draws it."""
    together = node("rover_0", s0=end(0), s1='<SubDAG type="uniform" var="rock_0"/>', s2=end(0))
    rover = node(
        "act",
        west=node("rover_0", s0=certain("rover_1", "s2"), s1=certain("rover_1", "s0"), s2=same("rover_1")),
        east=node("rover_0", s0=certain("rover_1", "s1"), s1=certain("rover_1", "s2"), s2=certain("rover_1", "s2")),
        check=same("rover_1"),
        sample=node("rover_0", s0=certain("rover_1", "s0"), s1=certain("rover_1", "s2"), s2=certain("rover_1", "2")),
    )
    stays = same("rock_1")
    rock = node(
        "act",
        west=stays,
        east=stays,
        check=stays,
        sample=node("rover_0", s0=certain("rock_1", "bad"), s1=stays, s2=stays),
    )
    nothing = certain("sensor", "ogood")
    near = node("rock_1", good=certain("sensor", "ogood"), bad=certain("sensor", "obad"))
    checked = node("rover_1", s0=near, s1='<SubDAG type="template" idref="far"/>', s2=nothing)
    sensor = node("act", west=nothing, east=nothing, check=checked, sample=nothing)
    far = node(
        "rock_1", good=node("sensor", ogood=end(0.8), obad=end(0.2)), bad=node("sensor", ogood=end(0.2), obad=end(0.8))
    )
    reward = node(
        "act",
        east=node("rover_0", s1=end(10)),
        west=node("rover_0", s0=end(-100)),
        sample=node("rover_0", s0=node("rock_0", good=end(10), bad=end(-10)), s1=end(-100)),
    )
    return {
        "belief": (function("CondProb", "rover_0 rock_0", "null", diagram(together)),),
        "moves": (
            function("CondProb", "rover_1", "act rover_0", diagram(rover)),
            function("CondProb", "rock_1", "act rover_0 rock_0", diagram(rock)),
        ),
        "views": (
            function(
                "CondProb",
                "sensor",
                "act rover_1 rock_1",
                diagram(sensor, f'<SubDAGTemplate id="far">{far}</SubDAGTemplate>'),
            ),
        ),
        "rewards": (function("Func", "the reward", "act rover_0 rock_0", diagram(reward)),),
    }


@pytest.mark.example
def test_diagrams_are_the_same_model(tmp_path: Path) -> None:
    tables, diagrams = read(tmp_path, document()), read(tmp_path, document(**as_diagrams()))
    assert diagrams.declared_known == {"rover"}
    for kind in ("initial", "transition", "observation", "reward"):
        for name, factor in getattr(tables, kind).items():
            other = getattr(diagrams, kind)[name]
            assert set(other.names) == set(factor.names)
            np.testing.assert_allclose(other.array_over(factor.scope), factor.array_over(factor.scope), atol=1e-15)


@pytest.mark.example
def test_belief_over_tied_variables(tmp_path: Path) -> None:
    variables = VARIABLES.replace('fullyObs="true"', "")
    together = function("CondProb", "rover_0 rock_0", "null", entries("ProbTable", "s0 -|0.1 0.3", "s1 good|0.6"))
    model = read(tmp_path, document(variables, belief=(together,)))
    assert model.initial["rover"].dense().array.tolist() == pytest.approx([0.4, 0.6, 0])
    rock = table(model.initial["rock"], model, "rover", "rock")
    np.testing.assert_allclose(rock, [[0.25, 0.75], [1, 0], [0.7, 0.3]])
    given = function("CondProb", "rock_0", "rover_0", entries("ProbTable", "s0 -|0.25 0.75", "s1 good|1", "s2 *|0.5"))
    alone = function("CondProb", "rover_0", "null", entries("ProbTable", "-|0.4 0.6 0"))
    model = read(tmp_path, document(variables, belief=(given, alone)))
    np.testing.assert_allclose(table(model.initial["rock"], model, "rover", "rock")[:2], rock[:2])


@pytest.mark.example
def test_stars_dashes_and_uniform_in_the_middle(tmp_path: Path) -> None:
    moves = entries("ProbTable", "* - * -|0.2 0.3 0.5 1 0 0 0 0 1", "west * bad *|uniform")
    function_of_rock = function("CondProb", "rover_1", "act rover_0 rock_0", moves)
    variables = VARIABLES.replace('fullyObs="true"', "")
    model = read(tmp_path, document(variables, moves=(function_of_rock, ROCK)))
    found = table(model.transition["rover"], model, "act", "rock", "rover", "rover.next")
    assert found[0, 0].tolist() == found[3, 1].tolist() == [[0.2, 0.3, 0.5], [1, 0, 0], [0, 0, 1]]
    np.testing.assert_allclose(found[0, 1], 1 / 3)


@pytest.mark.example
def test_several_rewards_of_next_states_and_observations(tmp_path: Path) -> None:
    variables = VARIABLES.replace('<RewardVar vname="the reward"/>', '<RewardVar vname="a"/><RewardVar vname="b"/>')
    rewards = (
        function("Func", "a", "rock_1 sensor", entries("ValueTable", "- -|1 2 3 4")),
        function("Func", "b", "act", entries("ValueTable", "*|-0.5")),
    )
    model = read(tmp_path, document(variables, rewards=rewards))
    assert model.reward["a"].names == ("rock.next", "sensor")
    assert model.reward["a"].dense().array.tolist() == [[1, 2], [3, 4]]
    assert model.reward["b"].names == ()
    assert float(model.reward["b"].dense().array) == -0.5


@pytest.mark.example
def test_two_observations_and_two_actions(tmp_path: Path) -> None:
    more = '<ObsVar vname="gps"><NumValues>3</NumValues></ObsVar>'
    more += '<ActionVar vname="arm"><NumValues>2</NumValues></ActionVar>'
    gps = function("CondProb", "gps", "rover_1", entries("ProbTable", "- -|identity"))
    model = read(tmp_path, document(VARIABLES + more, views=(SENSOR, gps)))
    assert model.variable("gps").values == ("o0", "o1", "o2")
    assert model.variable("arm").values == ("a0", "a1")
    assert model.observation["gps"].names == ("rover.next", "gps")
    assert model.joint_actions == 8


@pytest.mark.example
def test_fully_observed_with_an_uncertain_start_is_read_after_every_step(tmp_path: Path) -> None:
    belief = (function("CondProb", "rover_0", "null", entries("ProbTable", "-|0.5 0.5 0")), BELIEF[1])
    model = read(tmp_path, document(belief=belief))
    assert model.declared_known == set()
    assert [variable.name for variable in model.observations] == ["sensor", "rover_read"]
    assert table(model.observation["rover_read"], model, "rover.next", "rover_read").tolist() == np.eye(3).tolist()
    assert any("rover is fully observed, but its start is uncertain" in note for note in model.notes)


@pytest.mark.example
def test_other_pairs_of_names_are_called_by_the_first(tmp_path: Path) -> None:
    text = document().replace("rock_1", "rockThen").replace("rover_0", "act_0").replace("rover_1", "act_1")
    model = read(tmp_path, text)
    assert [variable.name for variable in model.states] == ["act_0", "rock_0"]
