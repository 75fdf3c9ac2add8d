"""Reads SARSOP's ``.pomdpx`` format.

The format is described by the Approximate POMDP Planning project of the National University of Singapore ("PomdpX file
format, version 1.0") and its schema ``pomdpx.xsd``. All of it is read: several variables of every kind, ``ValueEnum``
and ``NumValues`` (values ``s0``, ``a0``, ``o0``, …), tables and decision diagrams with templates, functions of
several variables together, ``*``, ``-``, ``identity`` and ``uniform``.

The model is as factored as the file: a state variable called ``rover_0`` and then ``rover_1`` is ``rover`` (any other
pair is called by its first name), and every function is a factor over those of its parents on which it depends.

A fully observed variable is ``known`` where its start is certain. Where it is not, the format means that the first
value is read before the first action; a belief here begins with no reading. Such a variable becomes one that an
observation ``…_read`` tells exactly after every step, and a note says that its first value is uncertain until then.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from factored_pomdp.factors import DeterministicFactor
from factored_pomdp.files.build import built, with_notes
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.pomdpx.functions import Functions, functions
from factored_pomdp.files.pomdpx.tree import Element, Lines, parsed
from factored_pomdp.files.pomdpx.variables import Declared, declared
from factored_pomdp.files.text import read_bytes
from factored_pomdp.files.values import all_numbers
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.validation import is_certain
from factored_pomdp.variables import Variable

__all__ = ["read_pomdpx"]


def read_pomdpx(path: Path) -> FactoredPOMDP:
    """The model in a ``.pomdpx`` file.

    Raises
    ------
    FileError
        With every fault, and its line.
    OSError
        Where the file cannot be read.
    """
    lines, faults = Lines(), FaultList()
    root = parsed(path, read_bytes(path), lines, faults)
    discount = _discount(root, lines, faults)
    variables = declared(root, lines, faults)
    found = functions(root, variables, lines, faults)
    faults.raise_if_any(path, lines.lines_of)
    return _model(path, discount, variables, found)


def _discount(root: Element, lines: Lines, faults: FaultList) -> float:
    element = root.first("Discount")
    if element is None and root.foreign:
        return 1.0
    numbers = all_numbers(element.text.split(maxsplit=2)) if element is not None else None
    if element is None or numbers is None or len(numbers) != 1 or not 0 <= numbers[0] <= 1:
        found = "nothing" if element is None else shortened(element.text.strip())
        line = root.line if element is None else element.line
        faults.note(lines.stamp(line), "<Discount>", found, "a number in [0, 1]")
        return 1.0
    return float(numbers[0])


def _model(path: Path, discount: float, variables: Declared, found: Functions) -> FactoredPOMDP:
    states = list(variables.before.values())
    known = variables.observed - _uncertain(found)
    seen, notes = list(variables.observations.values()), []
    taken = {variable.name for variable in (*states, *variables.actions.values(), *seen)}
    for state in states:
        if state.name in variables.observed and state.name not in known:
            name = f"{state.name}_read"
            while name in taken:
                name += "_"
            reading = Variable(name, state.values)
            seen.append(reading)
            found.observation[name] = DeterministicFactor([state.next], reading, np.arange(state.size))
            notes.append(
                f"{state.name} is fully observed, but its start is uncertain: {name} tells it after every step, and "
                "nothing before the first"
            )
    model = built(
        path,
        states=states,
        actions=list(variables.actions.values()),
        observations=seen,
        transition=found.transition,
        observation=found.observation,
        reward=found.reward,
        initial=found.initial,
        discount=discount,
        known=known,
    )
    return with_notes(model, notes)


def _uncertain(found: Functions) -> set[str]:
    """State variables whose first value is left to chance, or depends on one that is."""
    uncertain = {name for name, factor in found.initial.items() if not is_certain(factor, name)}
    while more := {n for n, f in found.initial.items() if n not in uncertain and uncertain & set(f.names)}:
        uncertain |= more
    return uncertain
