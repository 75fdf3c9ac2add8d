"""Domains as Gymnasium environments: its own checker, the same world as `Simulation`, masks, beliefs, plugins."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp import registry

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.utils.seeding import np_random  # noqa: E402

from factored_pomdp.gymnasium import Environment, register_domains  # noqa: E402

PAGE = Path(__file__).parents[3] / "docs" / "gymnasium.md"
BUILT_IN = {
    "tiger": {},
    "machine-repair": {"machines": 2, "coupled": True},
    "rocksample": {},
    "sysadmin": {},
    "valves": {},
    "surveillance": {"site": "micro", "targets": 2},
}


def maze() -> fp.FactoredPOMDP:
    """A corridor of three places with the way out at the right, and a hidden draught that slows steps down."""
    place = fp.Variable("place", [0, 1, 2])
    draught = fp.Variable("draught", ["calm", "strong"])

    def step(place: int, feet: str, draught: str) -> dict[int, float]:
        to = min(2, max(0, place + {"left": -1, "stay": 0, "right": 1}[feet]))
        return {to: 1.0} if draught == "calm" or to == place else {to: 0.5, place: 0.5}

    return fp.FactoredPOMDP(
        name="maze",
        states=[place, draught],
        actions=[fp.Variable("feet", ["left", "stay", "right"]), fp.Variable("eyes", ["open", "shut"])],
        observations=[fp.Variable("flag", ["still", "waves"])],
        transition={"place": step, "draught": lambda draught: {draught: 1.0}},
        observation={
            "flag": lambda draught_next, eyes: (
                "still" if eyes == "shut" else {"still": 0.2, "waves": 0.8} if draught_next == "strong" else "still"
            )
        },
        reward={"step": -1.0, "out": lambda place_next: 10.0 * (place_next == 2)},
        initial={"place": 0, "draught": {"calm": 0.5, "strong": 0.5}},
        known=["place"],
        legal={"feet": lambda place, feet: 0 <= place + {"left": -1, "stay": 0, "right": 1}[feet] <= 2},
        terminal=lambda place: place == 2,
        discount=0.9,
    )


@pytest.mark.end_to_end
@pytest.mark.parametrize("belief", [False, True])
@pytest.mark.parametrize("name", sorted(BUILT_IN))
def test_gymnasiums_own_checker_has_nothing_to_say(name: str, belief: bool) -> None:
    environment = gymnasium.make(f"factored_pomdp/{name}-v0", belief=belief, **BUILT_IN[name])
    check_env(environment.unwrapped)


@pytest.mark.end_to_end
def test_every_installed_domain_is_registered() -> None:
    assert set(BUILT_IN) <= set(registry.domain_names())
    assert register_domains() == [f"factored_pomdp/{name}-v0" for name in registry.domain_names()]
    assert set(register_domains()) <= set(gymnasium.registry)


@pytest.mark.end_to_end
def test_the_checker_on_a_model_with_legal_actions_and_an_end() -> None:
    for _ in range(5):
        check_env(Environment(maze(), belief=True), skip_render_check=True)


@pytest.mark.end_to_end
def test_no_import_but_gymnasiums_is_needed_and_ours_stays_light() -> None:
    program = (
        "import gymnasium; made = gymnasium.make('factored_pomdp.gymnasium:factored_pomdp/tiger-v0', accuracy=0.9);"
        "print(made.spec.id, made.reset(seed=1)[0])"
    )
    said = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False)
    assert said.stdout.split() == ["factored_pomdp/tiger-v0", "2"], said.stderr
    light = "import factored_pomdp, sys; factored_pomdp.FactoredPOMDP; sys.exit('gymnasium' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", light], check=False).returncode == 0


@pytest.mark.example
def test_the_same_world_as_the_simulation() -> None:
    model = maze()
    environment, world, rng = Environment(model), fp.Simulation(model), np_random(11)[0]
    observation, info = environment.reset(seed=11)
    state = world.start(rng)
    assert environment.decoded(observation) == {"place": 0}
    assert [mask.tolist() for mask in info["action_mask"]] == [[0, 1, 1], [1, 1]]
    for action in ({"feet": "stay", "eyes": "open"}, *[{"feet": "right", "eyes": "open"}] * 20):
        state, seen, reward = world.step(state, action, rng)
        observation, earned, terminated, truncated, info = environment.step(environment.encoded(action))
        assert environment.decoded(observation) == {**seen, "place": state["place"]}
        assert (earned, terminated, truncated) == (reward, model.is_terminal(state), False)
        if terminated:
            break
    assert state["place"] == 2
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"call reset\(\)"):
        environment.step(environment.encoded(action))


@pytest.mark.example
def test_spaces_are_positions_of_the_values() -> None:
    environment = Environment(maze())
    assert environment.action_space == gymnasium.spaces.MultiDiscrete([3, 2])
    assert environment.observation_space == gymnasium.spaces.Dict(
        {"flag": gymnasium.spaces.Discrete(3), "place": gymnasium.spaces.Discrete(3)}
    )
    assert environment.encoded({"eyes": "shut", "feet": "right"}).tolist() == [2, 1]
    tiger = Environment(fp.domain("tiger"))
    assert (tiger.action_space, tiger.observation_space) == (
        gymnasium.spaces.Discrete(3),
        gymnasium.spaces.Discrete(3),
    )
    assert tiger.encoded("open-right") == 2
    assert tiger.decoded(1) == {"heard": "right"}
    assert tiger.decoded(2) == {}


@pytest.mark.example
def test_wrong_actions_are_told_what_would_be_right() -> None:
    environment = Environment(maze())
    with pytest.raises(gymnasium.error.ResetNeeded):
        environment.step([1, 0])
    environment.reset(seed=3)
    with pytest.raises(ValueError, match="feet='left' is not legal at place=0; legal: 'stay', 'right'"):
        environment.step(np.array([0, 0]))
    with pytest.raises(
        ValueError, match=r"action \[3, 0\]: expected positions of values \(feet below 3, eyes below 2\)"
    ):
        environment.step([3, 0])
    observation, *_ = environment.step(np.array([1, 0]))
    assert environment.decoded(observation)["place"] == 0


@pytest.mark.example
def test_sampled_actions_are_legal() -> None:
    environment = Environment(maze())
    environment.action_space.seed(0)
    for episode in range(10):
        environment.reset(seed=episode)
        for _ in range(200):
            if environment.step(environment.action_space.sample())[2]:
                break
    _, info = environment.reset(seed=0)
    feet = {int(environment.action_space.sample(info["action_mask"])[0]) for _ in range(50)}
    assert feet == {1, 2}
    all_ones = tuple(np.ones(size, dtype=np.int8) for size in (3, 2))
    assert {int(environment.action_space.sample(all_ones)[0]) for _ in range(50)} == {0, 1, 2}


@pytest.mark.example
def test_the_belief_is_bayes_rule_while_the_episode_goes_on() -> None:
    environment = Environment(maze(), belief=True)
    observation, info = environment.reset(seed=2)
    belief = fp.initial_belief(environment.model)
    assert info["belief"] == {"draught": pytest.approx([0.5, 0.5])}
    terminated = False
    while not terminated:
        action = {"feet": "right", "eyes": "open"}
        observation, _, terminated, _, info = environment.step(environment.encoded(action))
        if not terminated:
            told = environment.decoded(observation)
            belief = belief.predict(action).condition({"flag": told["flag"]}, known={"place": told["place"]})
            assert info["belief"]["draught"].tolist() == belief.block("draught").array.tolist()
    assert "belief" not in info
    _, info = environment.reset()
    assert info["belief"]["draught"].tolist() == [0.5, 0.5]


@pytest.mark.example
def test_an_episode_is_truncated_where_that_was_asked_for() -> None:
    environment = gymnasium.make("factored_pomdp/tiger-v0", max_episode_steps=3)
    environment.reset(seed=0)
    assert [environment.step(0)[3] for _ in range(3)] == [False, False, True]
    assert gymnasium.spec("factored_pomdp/tiger-v0").max_episode_steps == 100


@pytest.mark.example
def test_several_at_once() -> None:
    worlds = gymnasium.make_vec("factored_pomdp/machine-repair-v0", num_envs=2, machines=2, belief=True)
    observation, info = worlds.reset(seed=4)
    assert observation["machine1.part"].tolist() == [3, 3]
    for _ in range(5):
        observation, reward, _, _, info = worlds.step(worlds.action_space.sample())
    assert reward.shape == (2,)
    assert info["belief"]["machine2"].sum(axis=1) == pytest.approx([1.0, 1.0])


@pytest.mark.example
def test_legal_actions_that_depend_on_hidden_things_are_refused() -> None:
    model = fp.FactoredPOMDP(
        states=[fp.Variable("bit", [0, 1])],
        actions=[fp.Variable("act", [0, 1])],
        observations=[],
        transition={"bit": lambda bit: {bit: 1.0}},
        observation={},
        reward=1.0,
        initial={"bit": {0: 0.5, 1: 0.5}},
        legal={"act": lambda bit, act: act <= bit},
    )
    with pytest.raises(ValueError, match="legal values of act depend on the hidden bit"):
        Environment(model)


@pytest.mark.example
def test_an_episode_that_starts_is_one_that_goes_on() -> None:
    model = fp.FactoredPOMDP(
        states=[fp.Variable("coin", ["tails", "heads"])],
        actions=[fp.Variable("throw", ["all"])],
        observations=[],
        transition={"coin": {"tails": 0.5, "heads": 0.5}},
        observation={},
        reward=-1.0,
        initial={"coin": {"tails": 0.5, "heads": 0.5}},
        terminal={"heads": 1},
    )
    environment = Environment(model)
    for seed in range(20):
        assert environment.reset(seed=seed)[0] == {}
        assert environment.step(0)[1] == -1.0


@pytest.mark.example
def test_plugins_are_environments_and_a_broken_one_harms_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    good = EntryPoint("cub", "factored_pomdp.domains.tiger:tiger", registry.DOMAINS)
    broken = EntryPoint("lion", "no_such_module_anywhere:lion", registry.DOMAINS)
    odd = EntryPoint("two words", "factored_pomdp.domains.tiger:tiger", registry.DOMAINS)
    monkeypatch.setattr(
        "importlib.metadata.entry_points", lambda group: [p for p in (good, broken, odd) if p.group == group]
    )
    monkeypatch.setattr("gymnasium.envs.registration.registry", {}, raising=True)
    monkeypatch.setattr("gymnasium.registry", gymnasium.envs.registration.registry)
    with pytest.warns(UserWarning, match="domain 'two words' is no environment"):
        assert register_domains() == ["factored_pomdp/cub-v0", "factored_pomdp/lion-v0"]
    assert gymnasium.make("factored_pomdp/cub-v0", accuracy=0.7).unwrapped.model.name == "tiger"
    with pytest.raises(ValueError, match=r"'lion' .* cannot be loaded: ModuleNotFoundError"):
        gymnasium.make("factored_pomdp/lion-v0")
    with pytest.raises(ValueError, match=r"'acuracy'.*did you mean 'accuracy'"):
        gymnasium.make("factored_pomdp/cub-v0", acuracy=0.7)


@pytest.mark.end_to_end
def test_the_pages_own_code(capsys: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 2
    names: dict[str, Any] = {}
    for block in blocks:
        exec(block, names)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 5
    assert all("'target2.sighting':" in line and "'south-west.preset':" in line for line in lines)
