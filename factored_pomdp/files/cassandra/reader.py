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
read before the first step). A reward that would be too large as one table, such as a number for every place with some
exceptions, becomes two whose sum it is: ``reward`` and ``reward_exceptions`` (`factored_pomdp.files.defaults`).
"""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor
from factored_pomdp.files.build import built, with_notes
from factored_pomdp.files.cassandra.preamble import KEYWORDS, Preamble
from factored_pomdp.files.cassandra.statements import LETTERS, Statements
from factored_pomdp.files.cassandra.tokens import Tokens
from factored_pomdp.files.defaults import as_terms
from factored_pomdp.files.faults import FaultList, FileError, FileFault, shortened
from factored_pomdp.files.tables import as_distribution, as_reward
from factored_pomdp.files.text import as_text, read_bytes
from factored_pomdp.files.values import LONGEST_NAME, near
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable

__all__ = ["read_cassandra"]

_FEWEST_WORDS = 4
"""Words and colons of the shortest statement about a table."""

_NEEDED = ("discount", "states", "actions", "observations")


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
    except TooLarge as problem:
        raise FileError(path, [FileFault("states, actions and observations", str(problem), "fewer of them")]) from None
    if tokens.cut:
        if not len(faults):
            faults.note(len(tokens) - 1, "statement", "more words than any can have here", "the next statement")
        faults.raise_if_any(path, tokens.lines_of)
    preamble.check_complete()
    tables, rewards = ({}, ()) if statements is None else _tables(statements, faults)
    faults.raise_if_any(path, tokens.lines_of)
    return _model(path, preamble, tables, rewards)


def _read_all(tokens: Tokens, preamble: Preamble, faults: FaultList) -> Statements | None:
    """Read preamble and tables; gives the tables, unless it cannot be told what they are about."""
    statements: Statements | None = None
    skipped, unread = False, None
    position = 0
    while position < len(tokens) and not faults.full:
        keyword, after = _keyword(tokens, position)
        if keyword in LETTERS:
            missing = [needed for needed in ("states", "actions") if needed not in preamble.variables]
            if statements is None and not missing:
                statements = Statements(tokens, preamble, faults)
            if statements is None or skipped:
                if not skipped and not all(map(preamble.lost, missing)):
                    faults.note(position, keyword, "a table", "'states:' and 'actions:' before it")
                skipped = True
                position = tokens.table_end(position)
            else:
                position = statements.read(position)
        elif keyword in KEYWORDS:
            end = tokens.statement_end(after)
            if keyword == "observations" and statements is not None:
                faults.note(position, keyword, "a list behind the first table", "it before all tables")
            else:
                preamble.read(keyword, tokens, after, end)
            position = end
        else:
            known = [*KEYWORDS, *LETTERS]
            word = tokens[position]
            faults.note(position, "statement", shortened(word), f"a keyword{near(word, known)}")
            _take_for_what_it_may_be(word, preamble)
            end = _next_known(tokens, position + 1)
            unread = position if end - position >= _FEWEST_WORDS else unread
            position = end
    if statements is None and not skipped and {"states", "actions"} <= preamble.variables.keys():
        statements = Statements(tokens, preamble, faults)
    if unread is not None and statements is not None:
        for kind in statements.kinds.values():
            kind.layers.doubts.add_everything(unread, certain=False)
    return None if skipped else statements


def _take_for_what_it_may_be(word: str, preamble: Preamble) -> None:
    """Count a misspelt keyword of the preamble as said, so that it is not missed as well."""
    close = get_close_matches(word.lower(), _NEEDED, n=1) if len(word) <= LONGEST_NAME else []
    for keyword in close:
        preamble.was_meant(keyword)


def _keyword(tokens: Tokens, position: int) -> tuple[str, int]:
    """The keyword at a position (empty if there is none), and where what it says begins."""
    word = tokens[position]
    if tokens[position + 1 : position + 2] == [":"]:
        return word if word in LETTERS else word.lower(), position + 2
    if word.lower() == "start" and tokens[position + 2 : position + 3] == [":"]:
        return f"start {tokens[position + 1].lower()}", position + 3
    return "", position


def _next_known(tokens: Tokens, begin: int) -> int:
    """Where the next keyword stands."""
    for position in range(begin, len(tokens)):
        word = tokens[position]
        colon = tokens[position + 1 : position + 2] == [":"]
        if (colon and (word in LETTERS or word.lower() in KEYWORDS)) or word.lower() == "start":
            return position
    return len(tokens)


def _tables(statements: Statements, faults: FaultList) -> tuple[dict[str, Factor | None], tuple[Factor, ...]]:
    """The distribution of each table by its letter, and the rewards; what is wrong with them is noted."""
    found: dict[str, Factor | None] = {}
    for letter, about in (("T", "transition of state.next"), ("O", "observation of observation")):
        kind = statements.kinds.get(letter)
        if kind is not None:
            found[letter] = as_distribution(kind.layers, kind.scope, kind.scope[-1], about, faults)
    earned = statements.kinds.get("R")
    rewards = as_reward(earned.layers, earned.scope, "reward", faults) if earned is not None else None
    return found, rewards or ()


def _model(
    path: Path, preamble: Preamble, tables: dict[str, Factor | None], rewards: tuple[Factor, ...]
) -> FactoredPOMDP:
    state, action = preamble.variables["states"], preamble.variables["actions"]
    seen = preamble.variables.get("observations")
    views = tables.get("O")
    if preamble.costs:
        rewards = tuple(map(_negated, rewards))
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
        transition={"state": tables["T"]},
        observation={} if seen is None else {"observation": views},
        reward=as_terms("reward", rewards),
        initial={"state": DenseFactor([state], belief)},
        discount=preamble.discount,
        known=known,
    )
    return with_notes(model, notes)


def _negated(reward: Factor) -> Factor:
    if isinstance(reward, DenseFactor):
        return DenseFactor(reward.scope, 0.0 - reward.array)
    sparse = reward.sparse()
    return type(sparse)(sparse.scope, sparse.coordinates, -sparse.numbers)
