"""Files of thousands of states whose reward is a number everywhere, with exceptions: loaded, written, solved."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.gymnasium import Environment
from solvers import QMDP
from solvers.flat import flatten
from solvers.mdp import state_values

STATES = 3_000
ACTIONS = ("north", "south", "east", "west", "stay")
MOST_MEMORY = 2_000_000_000
EXCEPTIONS = """R: * : * : * : * -1
R: north : * : * : * -2
R: stay : 77 : 77 : * 10
R: * : 5 : 6 : * 0
R: south : 70 : 10 : 2 -50
"""


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    """A table over states, next states and actions alone has 45,000,000 places; several such do not fit."""
    before = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_DATA, before)


def moves() -> str:
    """A ring where east leads on nine times in ten, and one way south."""
    steps = [("east", state, (state + 1) % STATES) for state in range(STATES)] + [("south", 70, 10)]
    return "T: * identity\n" + "".join(
        f"T: {name} : {state} : {state} 0.1\nT: {name} : {state} : {after} 0.9\n" for name, state, after in steps
    )


@pytest.fixture(scope="module")
def flat(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("large") / "given.pomdp"
    head = f"discount: 0.95\nstates: {STATES}\nactions: {' '.join(ACTIONS)}\nobservations: 3\n"
    path.write_text(f"{head}{moves()}O: * uniform\n{EXCEPTIONS}")
    return path


def earned(model: fp.FactoredPOMDP, action: str, state: int, after: int, seen: int) -> float:
    at = {"action": action, "state": str(state), "state.next": str(after), "observation": str(seen)}
    return sum(factor.value(at) for factor in model.reward.values())


def assert_same_rewards(one: fp.FactoredPOMDP, other: fp.FactoredPOMDP) -> None:
    assert list(one.reward) == list(other.reward)
    for name, factor in one.reward.items():
        table, twin = factor.sparse(), other.reward[name].sparse()
        assert table.names == twin.names
        np.testing.assert_array_equal(table.coordinates, twin.coordinates)
        np.testing.assert_array_equal(table.numbers, twin.numbers)


@pytest.mark.end_to_end
def test_loaded_and_written_it_is_the_same_model(flat: Path, tmp_path: Path) -> None:
    model = fp.load(flat)
    assert {name: factor.names for name, factor in model.reward.items()} == {
        "reward": ("action",),
        "reward_exceptions": ("action", "state", "state.next", "observation"),
    }
    assert model.reward["reward"].dense().array.tolist() == [-2, -1, -1, -1, -1]
    assert model.reward["reward_exceptions"].sparse().stored == 5 * 3 + 3 + 1
    fp.save(model, tmp_path / "again.pomdp")
    again = fp.load(tmp_path / "again.pomdp")
    assert_same_rewards(model, again)
    assert earned(again, "north", 1, 2, 0) == -2
    assert earned(again, "north", 5, 6, 0) == earned(again, "stay", 5, 6, 2) == 0
    assert earned(again, "stay", 77, 77, 1) == 10
    assert [earned(again, "south", 70, 10, seen) for seen in range(3)] == [-1, -1, -50]


@pytest.mark.end_to_end
def test_expected_rewards_values_and_steps(flat: Path) -> None:
    model = fp.load(flat)
    literal = fp.joint(model)
    expected = literal.reward
    assert expected.shape == (5, STATES)
    assert expected[4, 77] == pytest.approx(10, abs=1e-12)
    assert expected[2, 5] == pytest.approx(0.9 * 0 + 0.1 * -1, abs=1e-12)
    assert expected[1, 70] == pytest.approx(0.9 * (-1 - 1 - 50) / 3 + 0.1 * -1, abs=1e-12)
    assert (expected == np.array([-2, -1, -1, -1, -1])[:, None]).sum() == 5 * STATES - 3
    flattened = flatten(model)
    best = np.empty(STATES)
    best[flattened.order] = state_values(flattened)
    assert best[77] == pytest.approx(10 / (1 - 0.95), abs=1e-6)
    assert best[76] == pytest.approx((-1 + 0.9 * 0.95 * 200) / (1 - 0.1 * 0.95), abs=1e-6)
    ahead = [np.mean(line + 0.95 * (table @ best)) for line, table in zip(expected, literal.transition, strict=True)]
    assert QMDP(model).solve().upper == pytest.approx(max(ahead), abs=1e-6)
    environment = Environment(model)
    environment.reset(seed=1)
    _, reward, *_ = environment.step(0)
    assert reward == -2


@pytest.mark.end_to_end
def test_a_decision_process_without_observations(tmp_path: Path) -> None:
    head = f"discount: 0.95\nvalues: cost\nstates: {STATES}\nactions: {' '.join(ACTIONS)}\nstart: 0\n"
    text = "R: * : * : * 1\nR: stay : * : * 2\nR: * : 8 : 9 -4\n"
    (tmp_path / "seen.pomdp").write_text(f"{head}{moves()}{text}")
    model = fp.load(tmp_path / "seen.pomdp")
    assert model.declared_known == {"state"}
    assert list(model.reward) == ["reward", "reward_exceptions"]
    fp.save(model, tmp_path / "again.pomdp")
    again = fp.load(tmp_path / "again.pomdp")
    assert again.declared_known == {"state"}
    expected = fp.joint(again).reward
    assert expected[:, 8] == pytest.approx([-1, -1, 0.9 * 4 + 0.1 * -1, -1, -2], abs=1e-12)
    np.testing.assert_array_equal(expected, fp.joint(model).reward)


@pytest.mark.end_to_end
def test_a_function_of_a_pomdpx_file_with_a_default_becomes_two_rewards(tmp_path: Path) -> None:
    entry = "<Entry><Instance>{}</Instance><{}>{}</{}></Entry>".format
    said = {"* * *": -1, "a1 s3 s4": 9, "* s5 s5": 0}
    text = f"""<pomdpx><Discount>0.95</Discount><Variable>
<StateVar vnamePrev="old" vnameCurr="new"><NumValues>{STATES}</NumValues></StateVar>
<ActionVar vname="act"><NumValues>5</NumValues></ActionVar><ObsVar vname="seen"><NumValues>2</NumValues></ObsVar>
<RewardVar vname="bonus"/><RewardVar vname="cost"/></Variable><InitialStateBelief><CondProb><Var>old</Var>
<Parent>null</Parent><Parameter>{entry("-", "ProbTable", "uniform", "ProbTable")}</Parameter></CondProb>
</InitialStateBelief><StateTransitionFunction><CondProb><Var>new</Var><Parent>act old</Parent><Parameter>
{entry("* - -", "ProbTable", "identity", "ProbTable")}</Parameter></CondProb></StateTransitionFunction><ObsFunction>
<CondProb><Var>seen</Var><Parent>act</Parent><Parameter>{entry("* -", "ProbTable", "uniform", "ProbTable")}</Parameter>
</CondProb></ObsFunction><RewardFunction><Func><Var>bonus</Var><Parent>act</Parent><Parameter>
{entry("*", "ValueTable", 1, "ValueTable")}</Parameter></Func><Func><Var>cost</Var><Parent>act old new</Parent>
<Parameter>{"".join(entry(at, "ValueTable", number, "ValueTable") for at, number in said.items())}</Parameter></Func>
</RewardFunction></pomdpx>"""
    (tmp_path / "default.pomdpx").write_text(text)
    model = fp.load(tmp_path / "default.pomdpx")
    assert {name: factor.sparse().stored for name, factor in model.reward.items()} == {
        "bonus": 1,
        "cost": 1,
        "cost_exceptions": 6,
    }
    expected = np.zeros((5, STATES))
    expected[:, 5] = 1.0
    np.testing.assert_allclose(fp.joint(model).reward, expected, rtol=0, atol=1e-12)
    fp.save(model, tmp_path / "again.pomdpx")
    assert_same_rewards(model, fp.load(tmp_path / "again.pomdpx"))
    fp.save(model, tmp_path / "flat.pomdp")
    flat = fp.load(tmp_path / "flat.pomdp")
    rewards = [line for line in (tmp_path / "flat.pomdp").read_text().splitlines() if line.startswith("R:")]
    assert len(rewards) == 6
    assert "R: a1 : s3 : s4 : * 10.0" in rewards
    np.testing.assert_allclose(fp.joint(flat).reward, expected, rtol=0, atol=1e-12)
