"""Three ways to write a factor down give the same factor, and what cannot be read is said."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from factored_pomdp.errors import Fault
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, SparseFactor
from factored_pomdp.specification import resolve, table
from factored_pomdp.variables import Variable

CELLS = [(0, 0), (0, 1), (1, 0)]
WEATHER = Variable("weather", ["sun", "rain"])
PLACE = Variable("robot.place", CELLS)
ACT = Variable("act", ["wait", "go"])
VARIABLES = {v.name: v for v in (WEATHER, WEATHER.next, PLACE, PLACE.next, ACT)}


def resolved(specification: Any, child: Variable | None, faults: list[Fault] | None = None) -> Factor | None:
    noted: list[Fault] = [] if faults is None else faults
    factor = resolve(specification, child, VARIABLES, "here", noted)
    if faults is None:
        assert noted == []
    return factor


def fault(specification: Any, child: Variable | None = WEATHER.next) -> str:
    noted: list[Fault] = []
    assert resolved(specification, child, noted) is None
    assert len(noted) == 1
    return str(noted[0])


NUMBERS = np.array([[[0.9, 0.1], [0.5, 0.5]], [[0.2, 0.8], [0.0, 1.0]]])


def as_function(weather: str, act: str) -> Mapping[str, float]:
    row = NUMBERS[WEATHER.index(weather), ACT.index(act)]
    return {"sun": row[0], "rain": row[1]}


AS_MAPPING = {
    "sun": {"wait": {"sun": 0.9, "rain": 0.1}, "go": {"rain": 0.5, "sun": 0.5}},
    "rain": {"wait": {"sun": 0.2, "rain": 0.8}, "go": {"rain": 1.0}},
}


@pytest.mark.example
@pytest.mark.parametrize(
    "specification",
    [
        as_function,
        lambda act, weather: as_function(weather, act),
        table("weather", "act", WEATHER.next, values=NUMBERS),
        table("act", "weather", "weather.next", values=NUMBERS.transpose(1, 0, 2)),
        table("weather", "act", "weather.next", values=NUMBERS.tolist()),
        table(WEATHER, ACT, WEATHER.next, values=AS_MAPPING),
        table("weather", "act", values=lambda w, a: as_function(w, a)),
        table("weather", "act", "weather.next", values=lambda w, a: as_function(w, a)),
        DenseFactor([WEATHER, ACT, WEATHER.next], NUMBERS),
        DenseFactor([WEATHER.next, ACT, WEATHER], NUMBERS.transpose(2, 1, 0)),
        DenseFactor([WEATHER, ACT, WEATHER.next], NUMBERS).sparse(),
    ],
    ids=["function", "other order", "array", "axes", "lists", "mapping", "table", "child", "dense", "turned", "sparse"],
)
def test_every_way_gives_the_same_factor(specification: Any) -> None:
    factor = resolved(specification, WEATHER.next)
    assert set(factor.names) == {"weather", "act", "weather.next"}
    np.testing.assert_allclose(factor.array_over([WEATHER, ACT, WEATHER.next]), NUMBERS)


@pytest.mark.example
def test_a_function_that_gives_single_values_is_deterministic_also_with_values_that_are_tuples() -> None:
    def turn(robot_place: tuple[int, int], act: str) -> tuple[int, int]:
        return robot_place if act == "wait" else CELLS[(CELLS.index(robot_place) + 1) % 3]

    factor = resolved(turn, PLACE.next)
    assert isinstance(factor, DeterministicFactor)
    assert factor.indexes.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert factor.result({"robot.place": (1, 0), "act": "go"}) == (0, 0)


@pytest.mark.example
def test_single_values_and_distributions_may_be_mixed() -> None:
    factor = resolved(lambda robot_place: (0, 0) if robot_place == (0, 0) else {(0, 1): 0.5, (1, 0): 0.5}, PLACE.next)
    np.testing.assert_allclose(factor.array_over([PLACE, PLACE.next]), [[1, 0, 0], [0, 0.5, 0.5], [0, 0.5, 0.5]])


@pytest.mark.example
@pytest.mark.parametrize(
    ("specification", "numbers"),
    [
        ((0, 1), [0, 1, 0]),
        ({(0, 0): 0.25, (1, 0): 0.75}, [0.25, 0, 0.75]),
        ([0.5, 0.25, 0.25], [0.5, 0.25, 0.25]),
        (np.array([0.0, 0.0, 1.0]), [0, 0, 1]),
        (lambda: {(0, 0): 1.0}, [1, 0, 0]),
    ],
    ids=["a value", "a mapping", "a list", "an array", "a function of nothing"],
)
def test_a_start_without_parents(specification: Any, numbers: list[float]) -> None:
    np.testing.assert_allclose(resolved(specification, PLACE).array_over([PLACE]), numbers)


@pytest.mark.example
@pytest.mark.parametrize(
    ("specification", "numbers"),
    [
        (lambda weather_next, act: (weather_next == "sun") - 0.5 * (act == "go"), [[1, 0.5], [0, -0.5]]),
        (table("weather.next", "act", values=[[1, 0.5], [0, -0.5]]), [[1, 0.5], [0, -0.5]]),
        (
            table("act", "weather.next", values={"wait": {"sun": 1, "rain": 0}, "go": {"sun": 0.5, "rain": -0.5}}),
            [[1, 0.5], [0, -0.5]],
        ),
        (3, [[3, 3], [3, 3]]),
    ],
    ids=["function", "array", "mapping", "number"],
)
def test_rewards(specification: Any, numbers: list) -> None:
    array = resolved(specification, None).array_over([WEATHER.next, ACT])
    np.testing.assert_allclose(np.broadcast_to(array, (2, 2)), numbers)


@pytest.mark.example
def test_a_large_function_with_few_outcomes_is_kept_sparse() -> None:
    line = Variable("line", range(400))
    variables = {"line": line, "line.next": line.next}
    faults: list[Fault] = []
    factor = resolve(lambda line: {line: 0.5, (line + 1) % 400: 0.5}, line.next, variables, "here", faults)
    assert isinstance(factor, SparseFactor)
    assert factor.stored == 800


@pytest.mark.example
@pytest.mark.parametrize(
    ("specification", "message"),
    [
        (
            lambda wether, akt: "sun",
            "unknown 'wether', 'akt'; expected parameters named as variables (did you mean 'weather'?)",
        ),
        (table("weather", "moon", "weather.next", values=NUMBERS), "here: found the unknown variable 'moon'"),
        (
            table("weather.next", "weather", values=[[1, 0], [0, 1]]),
            "here: found axes weather.next, weather; expected weather.next as the last axis",
        ),
        (
            table("act", "act", "weather.next", values=NUMBERS),
            "here: found axes act, act, weather.next; expected every axis once",
        ),
        (
            table("weather", "weather.next", values=NUMBERS),
            "here: found an array of shape (2, 2, 2); expected shape (2, 2) for (weather, weather.next)",
        ),
        (
            table("weather", "weather.next", values=[[1, 0], [1]]),
            "here: found rows of different lengths, or values that are no numbers; expected numbers in shape (2, 2)",
        ),
        (
            table("weather", "weather.next", values={"sun": {"sun": 1}}),
            "here: found no entry for weather='rain'; expected every value listed",
        ),
        (
            table(
                "weather",
                "act",
                "weather.next",
                values={"sun": {"wait": {"sun": 1}}, "rain": {"wait": {"sun": 1}, "go": {"sun": 1}}},
            ),
            "here: found no entry for act='go' at weather=sun",
        ),
        (
            table("weather", "weather.next", values={"sun": {"sun": "much"}, "rain": {"sun": 1}}),
            "here: found 'much' at weather=sun, weather.next=sun; expected a number",
        ),
        (
            table("weather", "weather.next", values={"sun": {"sun": 1}, "rain": 1.0}),
            "here: found 1.0 where values of 'weather.next' are listed",
        ),
        (
            table("weather", "weather.next", values={"sun": {"sun": 1}, "snow": {"sun": 1}}),
            "'weather' has no value 'snow'",
        ),
        ("snow", "here: found 'snow'; expected a function, a fp.table(…), a Factor or a value"),
        (lambda weather: "snow", None),
        (DenseFactor([WEATHER, Variable("moon", [0])], [[1], [1]]), "here: found the unknown variable 'moon'"),
        (
            DenseFactor([Variable("weather", "abc"), WEATHER.next], np.ones((3, 2)) / 2),
            "here: found another 'weather' with 3 values",
        ),
        (
            DenseFactor([WEATHER, ACT], np.ones((2, 2))),
            "here: found a factor over weather, act; expected weather.next in its scope",
        ),
    ],
)
def test_what_cannot_be_read(specification: Any, message: str | None) -> None:
    if message is not None:
        assert message in fault(specification)
        return
    noted: list[Fault] = []
    assert resolved(specification, WEATHER.next, noted) is None
    assert [f.where for f in noted] == ["here at weather=sun", "here at weather=rain"]
    assert noted[0].found.startswith("'snow' (")


@pytest.mark.example
@pytest.mark.parametrize(
    ("function", "child", "found"),
    [
        (lambda weather: {"sun": 1.0}[weather], WEATHER.next, "KeyError ('rain')"),
        (lambda weather: {weather: "all"}, WEATHER.next, "{'rain': 'all'} ("),
        (
            lambda weather: {"sun": 1.0} if weather == "sun" else {"mist": 1.0},
            WEATHER.next,
            "{'mist': 1.0} ('weather.next' has no value 'mist'",
        ),
        (lambda weather: 1.0 if weather == "sun" else "a lot", None, "'a lot' ("),
    ],
)
def test_faults_of_functions_name_the_assignment(function: Callable, child: Variable | None, found: str) -> None:
    noted: list[Fault] = []
    assert resolved(function, child, noted) is None
    assert noted[-1].where == "here at weather=rain"
    assert noted[-1].found.startswith(found)


@pytest.mark.example
def test_a_parameter_that_may_mean_two_variables_is_refused() -> None:
    variables = {name: Variable(name, [0, 1]) for name in ("a.b", "a_b", "c")}
    faults: list[Fault] = []
    assert resolve(lambda a_b: 1.0, None, variables, "here", faults) is None
    assert (
        str(faults[0])
        == "here: found the parameter 'a_b'; expected fp.table(…) with names of axes, as it may mean a.b or a_b"
    )
    assert resolve(lambda c: 1.0, None, variables, "here", []) is not None
