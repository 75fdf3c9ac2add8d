"""Faulty ``.pomdp`` files: all faults at once, each with its line, what was found and what would be right."""

from __future__ import annotations

from pathlib import Path

import pytest

import factored_pomdp as fp

GOOD = """discount: 0.95
values: reward
states: left right
actions: listen open
observations: l r
T: listen identity
T: open uniform
O: listen
0.85 0.15
0.15 0.85
O: open uniform
R: * : * : * : * -1
"""


def faults(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "bad.pomdp"
    path.write_text(text)
    with pytest.raises(fp.FileError) as caught:
        fp.load(path)
    assert str(caught.value).startswith(str(path))
    return [str(fault) for fault in caught.value.faults]


@pytest.mark.example
@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("discount: 0.95", "discount: 1.5", "line 1: discount: found '1.5'; expected a number in [0, 1]"),
        ("discount: 0.95\n", "", "discount: found nothing; expected a number in [0, 1]"),
        ("values: reward", "values: rewards", "line 2: values: found 'rewards'; expected 'reward' or 'cost'"),
        ("left right", "left left right", "line 3: states: found 'left' again; expected every name once"),
        ("states: left right", "states: 0", "line 3: states: found '0'; expected 1 to 500,000"),
        (
            "states:",
            "state:",
            "line 3: statement: found 'state'; expected a keyword (did you mean 'states'?)",
        ),
        (
            "T: listen identity",
            "T: listne identity",
            "line 6: T: found 'listne'; expected an action (did you mean 'listen'?) or *",
        ),
        (
            "T: open uniform",
            "T: open : left : top 1",
            "line 7: T: found 'top'; expected a state (there are: left, right) or *",
        ),
        (
            "T: open uniform",
            "T: open\n0.5 0.5 0.5",
            "line 8: T: open: found 3 numbers; expected 4 numbers (2 × 2)",
        ),
        (
            "T: open uniform",
            "T: open\n0.5 0.5 0.5 0.5\n0.5",
            "line 9: T: found 1 more numbers than expected; expected the next statement",
        ),
        (
            "T: open uniform",
            "T: open : left 0.7 0.2",
            "line 7: transition of state.next at action=open, state=left: found probabilities that sum to 0.9; "
            "expected sum 1",
        ),
        (
            "0.85 0.15",
            "1.85 -0.85",
            "line 8: observation of observation at action=listen, state.next=left, observation=l: found 1.85; "
            "expected a probability in [0, 1]",
        ),
        ("R: * : * : * : * -1", "R: * : * : * : * nan", "line 12: R: found 'nan'; expected a finite number"),
        (
            "R: * : * : * : * -1",
            "R: * : * : * : *",
            "line 12: R: * : * : * : *: found the end of the file; expected a number",
        ),
        ("R: * : * : * : * -1", "R: open 1", "line 12: R: found an action only; expected an action and a state"),
        (
            "R: * : * : * : * -1",
            "R: open : left uniform",
            "line 12: R: open : left: found 'uniform'; expected 4 numbers (2 × 2)",
        ),
        ("O: open uniform", "O: open : left identity", "line 11: O: found identity; expected numbers (identity takes"),
        (
            "T: listen identity",
            "start: 0.5 0.4\nT: listen identity",
            "line 6: start: found probabilities that sum to 0.9",
        ),
        ("T: listen identity", "start: 0.5\nT: listen identity", "line 6: start: found '0.5'; expected a state"),
        ("T: listen identity", "start: up\nT: listen identity", "line 6: start: found 'up'; expected a state"),
        (
            "T: listen identity",
            "start exclude: left right\nT: listen identity",
            "found every state; expected at least one",
        ),
        ("observations: l r\n", "", "line 7: O: found an observation table; expected 'observations:' before it"),
        ("discount: 0.95", "discount: 0.95\ndiscount: 0.9", "line 2: discount: found a second one; expected one"),
    ],
)
def test_one_fault(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    found = faults(tmp_path, GOOD.replace(old, new))
    assert any(fault.startswith(expected) or expected in fault for fault in found), found


@pytest.mark.example
def test_rows_that_nobody_gave_are_named_without_a_line(tmp_path: Path) -> None:
    found = faults(tmp_path, GOOD.replace("T: open uniform", "T: open : left : left 1"))
    assert found == [
        "transition of state.next at action=open, state=right: found no distribution; expected sum 1",
    ]


@pytest.mark.example
def test_all_faults_at_once_in_order(tmp_path: Path) -> None:
    text = GOOD.replace("T: open uniform", "T: opne uniform").replace("0.15 0.85", "0.15 eighty")
    text = text.replace("* -1", "* minus").replace("discount: 0.95", "discount: ten")
    found = faults(tmp_path, text)
    assert [fault.split(":")[0] for fault in found] == ["line 1", "line 7", "line 10", "line 12"]
    assert found[2] == "line 10: O: listen: found 'eighty'; expected 4 numbers (2 × 2)"


@pytest.mark.example
def test_several_wrong_sums_at_once(tmp_path: Path) -> None:
    text = GOOD.replace("0.85 0.15", "0.85 0.25").replace("T: open uniform", "T: open : * 0.5 0.25")
    assert [fault[:60] for fault in faults(tmp_path, text)] == [
        "line 7: transition of state.next at action=open, state=left:",
        "line 7: transition of state.next at action=open, state=right",
        "line 8: observation of observation at action=listen, state.n",
    ]


@pytest.mark.example
def test_wrong_numbers_are_told_beside_wrong_words(tmp_path: Path) -> None:
    text = """discount: 0.95
states: a b c
actions: go stay
observations: x y
start: 0.2 0.2 0.2
T: go : a
0.5 0.4 0.0
T: gone : a : b 0.3
T: go : b : 7 1
T: stay identity
O: go
0.5 0.5
0.2 0.9
-0.2 1.2
O: saty uniform
Q: 1
"""
    assert [fault.split("; ")[0] for fault in faults(tmp_path, text)] == [
        "line 5: start: found probabilities that sum to 0.6",
        "line 6: transition of state.next at action=go, state=a: found probabilities that sum to 0.9",
        "line 8: T: found 'gone'",
        "line 9: T: found '7'",
        "line 11: observation of observation at action=go, state.next=c, observation=x: found -0.2",
        "line 11: observation of observation at action=go, state.next=c, observation=y: found 1.2",
        "line 11: observation of observation at action=go, state.next=b: found probabilities that sum to 1.1",
        "line 15: O: found 'saty'",
        "line 16: statement: found 'Q'",
        "transition of state.next at action=go, state=c: found no distribution",
    ]


@pytest.mark.example
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("T: open uniform", "T: opne uniform"),
        ("T: open uniform", "T: * identical"),
        ("T: open uniform", "T: open : left uniform\nT: open : right"),
        ("T: open uniform", "Tr: open uniform"),
        ("observations: l r", "observations: l l"),
        ("observations: l r", "observation: l r"),
        ("observations: l r\n", ""),
        ("states: left right", "states: left left"),
        ("states: left right", "state: left right"),
        ("actions: listen open", "actions: 0"),
        ("T: listen identity", "start: 0.5 0.6\nT: listen reset"),
        ("T: listen identity", "T: listen : left : left 1\nT: listen : right : rihgt 1"),
        ("discount: 0.95", "discuont: 0.95"),
    ],
)
def test_a_fault_has_no_faults_as_its_consequence(tmp_path: Path, old: str, new: str) -> None:
    assert len(faults(tmp_path, GOOD.replace(old, new))) == 1


@pytest.mark.example
def test_the_good_file_is_good(tmp_path: Path) -> None:
    path = tmp_path / "good.POMDP"
    path.write_text(GOOD)
    assert fp.load(path).notes == ()


@pytest.mark.example
def test_other_endings_and_missing_files(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"'\.xml'; expected a name that ends with \.pomdp or \.pomdpx"):
        fp.load(tmp_path / "model.xml")
    with pytest.raises(FileNotFoundError):
        fp.load(tmp_path / "nothing.pomdp")
    (tmp_path / "folder.pomdp").mkdir()
    with pytest.raises(fp.FileError, match="found something that is not a regular file"):
        fp.load(tmp_path / "folder.pomdp")
