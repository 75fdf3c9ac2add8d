"""Reads Cassandra's ``.pomdp`` format.

The format is described by A. R. Cassandra at pomdp.org ("POMDP file format", "POMDP file grammar"). All of it is read:
named and counted states, actions and observations, ``*``, entry, row and matrix forms, ``uniform``, ``identity``,
``reset``, every form of ``start``, ``values: cost``. Statements may be broken into lines anywhere, and later ones hold
over earlier ones. What the description leaves open is read generously: the parts of the preamble may come in any order,
a number may begin with its point or a plus.

The model has one state variable ``state``, one action variable ``action`` and one observation variable
``observation`` (values that are only counted are named ``"0"``, ``"1"``, …), and each table is a factor over those
variables on which it depends. A file without ``observations:`` is a Markov decision process, whose state is seen: it is
``known`` where its start is certain, and otherwise the observation *is* the next state, which a note says (nothing is
read before the first step).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor
from factored_pomdp.files.build import built, with_notes
from factored_pomdp.files.cassandra.preamble import KEYWORDS, Preamble
from factored_pomdp.files.cassandra.statements import LETTERS, Statements
from factored_pomdp.files.cassandra.tokens import Tokens
from factored_pomdp.files.faults import FaultList, FileError, FileFault, shortened
from factored_pomdp.files.tables import as_distribution, as_reward
from factored_pomdp.files.text import as_text, read_bytes
from factored_pomdp.files.values import near
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.validation import TOLERANCE
from factored_pomdp.variables import Variable

__all__ = ["read_cassandra"]


def read_cassandra(path: Path) -> FactoredPOMDP:
    """The model in a ``.pomdp`` file.

    Raises
    ------
    FileError
        With every fault, and its line.
    OSError
        Where the file cannot be read.

    Notes
    -----
    Time and memory grow with the file and with the numbers that are not zero, never with what is only counted.
    """
    tokens, faults = Tokens(as_text(path, read_bytes(path))), FaultList()
    preamble = Preamble(faults)
    try:
        statements = _read_all(tokens, preamble, faults)
        preamble.check_complete()
        faults.raise_if_any(path, tokens.lines_of)
        statements = statements or Statements(tokens, preamble, faults)
    except TooLarge as problem:
        raise FileError(path, [FileFault("states, actions and observations", str(problem), "fewer of them")]) from None
    return _model(path, tokens, preamble, statements, faults)


def _read_all(tokens: Tokens, preamble: Preamble, faults: FaultList) -> Statements | None:
    """Read preamble and tables; gives the tables, if there are any."""
    statements: Statements | None = None
    position = 0
    while position < len(tokens) and not faults.full:
        keyword, after = _keyword(tokens, position)
        if keyword in LETTERS:
            if statements is None:
                if not {"states", "actions"} <= preamble.variables.keys():
                    if not len(faults):
                        faults.note(position, keyword, "a table", "'states:' and 'actions:' before it")
                    break
                statements = Statements(tokens, preamble, faults)
            position = statements.read(position)
        elif keyword in KEYWORDS:
            end = _next_statement(tokens, after)
            if keyword == "observations" and statements is not None:
                faults.note(position, keyword, "a list behind the first table", "it before all tables")
            else:
                preamble.read(keyword, tokens, after, end)
            position = end
        else:
            known = [*KEYWORDS, *LETTERS]
            faults.note(position, "statement", shortened(tokens[position]), f"a keyword{near(keyword, known)}")
            position = _next_known(tokens, position + 1)
    return statements


def _keyword(tokens: Tokens, position: int) -> tuple[str, int]:
    """The keyword at a position (empty if there is none), and where what it says begins."""
    word = tokens[position]
    if tokens[position + 1 : position + 2] == [":"]:
        return word if word in LETTERS else word.lower(), position + 2
    if word.lower() == "start" and tokens[position + 2 : position + 3] == [":"]:
        return f"start {tokens[position + 1].lower()}", position + 3
    return "", position


def _next_statement(tokens: Tokens, begin: int) -> int:
    """Where a list of words ends: before the word that a colon follows."""
    try:
        colon = tokens.index(":", begin)
    except ValueError:
        return len(tokens)
    two_words = colon - 2 >= begin and tokens[colon - 2].lower() == "start"
    if two_words and tokens[colon - 1].lower() in ("include", "exclude"):
        return colon - 2
    return max(colon - 1, begin)


def _next_known(tokens: Tokens, begin: int) -> int:
    """Where the next keyword stands."""
    for position, (word, after) in enumerate(zip(tokens[begin:], [*tokens[begin + 1 :], ""], strict=False), begin):
        if (after == ":" and (word in LETTERS or word.lower() in KEYWORDS)) or word.lower() == "start":
            return position
    return len(tokens)


def _model(path: Path, tokens: Tokens, preamble: Preamble, statements: Statements, faults: FaultList) -> FactoredPOMDP:
    state, action = preamble.variables["states"], preamble.variables["actions"]
    seen = preamble.variables.get("observations")
    _check_start(preamble, faults)
    transition, reward = statements.kinds["T"], statements.kinds["R"]
    moves = as_distribution(transition.layers, transition.scope, state.next, f"transition of {state.next.name}", faults)
    earned = as_reward(reward.layers, reward.scope, "reward", faults)
    views: Factor | None = None
    if seen is not None:
        table = statements.kinds["O"]
        views = as_distribution(table.layers, table.scope, seen, f"observation of {seen.name}", faults)
    faults.raise_if_any(path, tokens.lines_of)
    if preamble.costs and earned is not None:
        earned = _negated(earned)
    belief = preamble.belief()
    notes: list[str] = []
    known: tuple[str, ...] = ()
    if seen is None:
        if np.isin(belief, (0.0, 1.0)).all():
            known = ("state",)
        else:
            seen = Variable("observation", state.values)
            views = DeterministicFactor([state.next], seen, np.arange(state.size))
            notes.append("no observations in the file: after every step the state is observed (not before the first)")
    model = built(
        path,
        states=[state],
        actions=[action],
        observations=[] if seen is None else [seen],
        transition={"state": moves},
        observation={} if seen is None else {"observation": views},
        reward={"reward": earned},
        initial={"state": DenseFactor([state], belief)},
        discount=preamble.discount,
        known=known,
    )
    return with_notes(model, notes)


def _check_start(preamble: Preamble, faults: FaultList) -> None:
    belief = preamble.belief()
    where = "start"
    if not ((belief >= 0) & (belief <= 1 + TOLERANCE)).all():
        faults.note(preamble.start_stamp, where, "a number outside of [0, 1]", "probabilities")
    elif not abs(belief.sum() - 1) <= TOLERANCE:
        faults.note(preamble.start_stamp, where, f"probabilities that sum to {belief.sum():.9g}", "sum 1")


def _negated(reward: Factor) -> Factor:
    if isinstance(reward, DenseFactor):
        return DenseFactor(reward.scope, 0.0 - reward.array)
    sparse = reward.sparse()
    return type(sparse)(sparse.scope, sparse.coordinates, -sparse.numbers)
