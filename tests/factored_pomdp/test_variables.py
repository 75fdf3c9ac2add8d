"""Variables: names, values, the next slice."""

from __future__ import annotations

import pytest

from factored_pomdp.variables import Variable, count


@pytest.mark.example
def test_values_may_be_anything_hashable() -> None:
    place = Variable("place", [(0, 0), (0, 1), "outside"])
    assert place.size == 3
    assert [place.index(value) for value in place.values] == [0, 1, 2]
    assert count([place, place.next]) == 9
    assert count([]) == 1


@pytest.mark.example
def test_the_next_slice_has_the_same_values_and_leads_back() -> None:
    weather = Variable("weather", ["sun", "rain"])
    assert weather.next.name == "weather.next"
    assert weather.next.values is weather.values
    assert weather.next.is_next
    assert not weather.is_next
    assert weather.next.now == weather
    assert weather.now is weather
    assert weather.next.index("rain") == 1
    with pytest.raises(ValueError, match=r"'weather\.next' is of the next slice already"):
        _ = weather.next.next


@pytest.mark.example
def test_equal_by_name_and_values() -> None:
    one = Variable("x", [0, 1])
    assert one == Variable("x", (0, 1))
    assert hash(one) == hash(Variable("x", (0, 1)))
    assert one != Variable("y", [0, 1])
    assert one != Variable("x", [1, 0])
    assert one.renamed("y") == Variable("y", [0, 1])
    assert one != "x"


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("", [0], "a variable needs a name"),
        ("x", [], "variable 'x' has no values; it needs at least one"),
        ("x", ["a", "b", "a"], "variable 'x' has the value 'a' more than once"),
        ("x", ["a", None], "variable 'x' has the value None, which means 'not read'"),
    ],
)
def test_what_is_wrong_is_said_at_once(name: str, values: list, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Variable(name, values)


@pytest.mark.example
def test_an_unknown_value_is_named_with_those_that_there_are() -> None:
    with pytest.raises(ValueError, match=r"'weather' has no value 'rein' \(did you mean 'rain'\?\)"):
        Variable("weather", ["sun", "rain"]).index("rein")
    with pytest.raises(ValueError, match=r"'n' has no value \[1\] \(there are 20: 0, 1, 2, 3, 4, 5, …\)"):
        Variable("n", range(20)).index([1])
