"""The variables that a ``.pomdpx`` file declares, by the names the file gives them."""

from __future__ import annotations

from dataclasses import dataclass, field

from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.pomdpx.tree import Element, Lines
from factored_pomdp.files.values import LONGEST_NAME, MOST_VALUES, near
from factored_pomdp.variables import Variable

__all__ = ["LETTERS", "Declared", "declared", "named", "whole"]

LETTERS = {"StateVar": "s", "ObsVar": "o", "ActionVar": "a"}
"""What values that are only counted begin with."""


@dataclass
class Declared:
    """Variables of a file.

    Attributes
    ----------
    before, after, actions, observations : dict
        The model's variable for each name in the file; ``before`` by ``vnamePrev``, ``after`` by ``vnameCurr``.
    rewards : set of str
    observed : set of str
        Names (the model's) of fully observed state variables.
    broken : set of str
        Names (the file's) of variables whose values could not be read.
    complete : bool
        Whether the name of every variable could be read.
    """

    before: dict[str, Variable] = field(default_factory=dict)
    after: dict[str, Variable] = field(default_factory=dict)
    actions: dict[str, Variable] = field(default_factory=dict)
    observations: dict[str, Variable] = field(default_factory=dict)
    rewards: set[str] = field(default_factory=set)
    observed: set[str] = field(default_factory=set)
    broken: set[str] = field(default_factory=set)
    complete: bool = True


def declared(root: Element, lines: Lines, faults: FaultList) -> Declared:
    """Read the ``Variable`` section; all that is wrong with it is noted."""
    found = Declared()
    sections = root.all("Variable")
    found.complete = not root.foreign and not any(section.foreign for section in sections)
    if not sections and not root.foreign:
        found.complete = False
        faults.note(lines.stamp(root.line), "<pomdpx>", "no <Variable>", "the variables")
    elements = [element for section in sections for element in section.children]
    taken: set[str] = set()
    stems = _stems(elements)
    for element in elements:
        stamp = lines.stamp(element.line)
        names = [
            _attribute(element, key, stamp, taken, faults)
            for key in (("vnamePrev", "vnameCurr") if element.tag == "StateVar" else ("vname",))
        ]
        if not all(names):
            found.complete = False
            found.broken.update(filter(None, names))
            continue
        if element.tag == "RewardVar":
            found.rewards.add(names[0])
            continue
        values = _values(element, lines, faults)
        if not values:
            found.broken.update(names)
            continue
        if element.tag == "StateVar":
            state = Variable(stems.get(names[0], names[0]), values)
            found.before[names[0]], found.after[names[1]] = state, state.next
            if _is_observed(element, stamp, faults):
                found.observed.add(state.name)
        else:
            kind = found.actions if element.tag == "ActionVar" else found.observations
            kind[names[0]] = Variable(names[0], values)
    return found


def whole(text: str) -> str:
    """A name with single blanks."""
    return " ".join(text.split())


def named(
    element: Element, known: dict[str, Variable], declared: Declared, lines: Lines, faults: FaultList
) -> list[Variable] | None:
    """The variables whose names an element lists; ``None`` after a fault was noted, of this list or of a variable."""
    text = whole(element.text)
    if text in known:
        return [known[text]]
    found = []
    for word in text.split():
        if word in declared.broken or (word not in known and not declared.complete):
            return None
        if word not in known:
            expected = f"a variable that may stand here{near(word, known)}"
            faults.note(lines.stamp(element.line), f"<{element.tag}>", shortened(word), expected)
            return None
        found.append(known[word])
    if len(set(found)) != len(found):
        faults.note(lines.stamp(element.line), f"<{element.tag}>", shortened(text), "every variable once")
        return None
    return found


def _stems(elements: list[Element]) -> dict[str, str]:
    """``rover`` for a variable called ``rover_0`` and then ``rover_1``, where nothing else is called that."""
    names = [element.attributes.get(key, "") for element in elements for key in ("vnamePrev", "vnameCurr", "vname")]
    taken, stems = {whole(name) for name in names}, {}
    for element in elements:
        before, after = (whole(element.attributes.get(key, "")) for key in ("vnamePrev", "vnameCurr"))
        stem = before.removesuffix("_0")
        if stem and before == f"{stem}_0" and after == f"{stem}_1" and stem not in taken:
            stems[before] = stem
    return stems


def _attribute(element: Element, key: str, stamp: int, taken: set[str], faults: FaultList) -> str:
    name = whole(element.attributes.get(key, ""))
    if not name:
        faults.note(stamp, f"<{element.tag}>", f"no {key}", f"{key}, the variable's name")
    elif name in taken:
        faults.note(stamp, f"<{element.tag}>", f"{shortened(name)} again", "every name once")
        return ""
    taken.add(name)
    return name


def _values(element: Element, lines: Lines, faults: FaultList) -> list[str]:
    listed, number = element.first("ValueEnum"), element.first("NumValues")
    where = f"<{element.tag}> {shortened(element.attributes.get('vnamePrev', element.attributes.get('vname', '')))}"
    if listed is not None:
        values = listed.text.split(maxsplit=MOST_VALUES + 1)
        long = next((value for value in values if len(value) > LONGEST_NAME), "")
        if long:
            found = f"{shortened(long)}, a name of {len(long):,} characters"
            faults.note(lines.stamp(listed.line), where, found, f"at most {LONGEST_NAME:,}")
            return []
        if values and len(values) <= MOST_VALUES and len(set(values)) == len(values):
            return values
        twice = next((value for value in values if values.count(value) > 1), "") if len(values) < 10_000 else ""
        found = f"{shortened(twice)} more than once" if twice else f"{len(values):,} names"
        faults.note(lines.stamp(listed.line), where, found, f"1 to {MOST_VALUES:,} names, no two equal")
        return []
    if number is None and element.foreign:
        return []
    text = number.text.strip() if number is not None else ""
    if text.isascii() and text.isdigit() and len(text) < 15 and 1 <= int(text) <= MOST_VALUES:
        return [f"{LETTERS[element.tag]}{position}" for position in range(int(text))]
    found = f"NumValues {shortened(text)}" if number is not None else "neither ValueEnum nor NumValues"
    line = number.line if number is not None else element.line
    faults.note(lines.stamp(line), where, found, f"the values' names, or how many (1 to {MOST_VALUES:,})")
    return []


def _is_observed(element: Element, stamp: int, faults: FaultList) -> bool:
    text = element.attributes.get("fullyObs", "false").strip().lower()
    if text not in ("true", "false", "1", "0"):
        faults.note(stamp, "<StateVar>", f"fullyObs={shortened(text)}", "'true' or 'false'")
    return text in ("true", "1")
