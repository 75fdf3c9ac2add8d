"""The functions of a ``.pomdpx`` file: beliefs, transitions, observations and rewards, each to factors of the model."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import Factor
from factored_pomdp.files.chain import chained
from factored_pomdp.files.defaults import as_terms
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.pomdpx.diagram import read_diagram
from factored_pomdp.files.pomdpx.table import read_table
from factored_pomdp.files.pomdpx.tree import Element, Lines
from factored_pomdp.files.pomdpx.variables import Declared, named, whole
from factored_pomdp.files.tables import as_distribution, as_reward
from factored_pomdp.files.values import near
from factored_pomdp.variables import Variable

__all__ = ["Functions", "functions"]


@dataclass
class Functions:
    """Factors by the model's names."""

    initial: dict[str, Factor] = field(default_factory=dict)
    transition: dict[str, Factor] = field(default_factory=dict)
    observation: dict[str, Factor] = field(default_factory=dict)
    reward: dict[str, Factor] = field(default_factory=dict)


def functions(root: Element, variables: Declared, lines: Lines, faults: FaultList) -> Functions:
    """Read every function; what is wrong is noted, and that function left out.

    Where there is no function of a variable, that is noted too, unless one that could not be read may be about it.
    """
    found = Functions()
    everything = variables.before | variables.after | variables.actions | variables.observations
    sections = (
        ("InitialStateBelief", variables.before, variables.before, found.initial, "initial belief"),
        ("StateTransitionFunction", variables.after, everything, found.transition, "transition"),
        ("ObsFunction", variables.observations, everything, found.observation, "observation"),
    )
    for tag, about, parents, into, kind in sections:
        named: set[str] = set()
        lost = root.foreign or not variables.complete or any(section.foreign for section in root.all(tag))
        for element in _all(root, tag):
            read = _Function(element, parents, variables, lines, faults)
            children = read.variables("Var", about)
            lost = lost or not children
            if children and read.has_parts(faults):
                twice = [child.now.name for child in children if child.now.name in named]
                if twice:
                    faults.note(read.stamp, "<Var>", f"a second {kind} of {twice[0]}", "one")
                for name, factor in read.distributions(children, kind).items():
                    into.setdefault(name, factor)
            named.update(child.now.name for child in children or ())
        for variable in about.values():
            if variable.now.name not in named and not lost:
                faults.note(None, f"{kind} of {variable.name}", "no distribution", "one for every variable")
    _rewards(root, variables, everything, found, lines, faults)
    return found


def _rewards(
    root: Element,
    variables: Declared,
    parents: dict[str, Variable],
    found: Functions,
    lines: Lines,
    faults: FaultList,
) -> None:
    named: set[str] = set()
    lost = root.foreign or not variables.complete or any(section.foreign for section in root.all("RewardFunction"))
    for element in _all(root, "RewardFunction"):
        read = _Function(element, parents, variables, lines, faults)
        name = read.reward(named)
        earned = read.value(name) if name and read.has_parts(faults) else None
        if earned is not None:
            found.reward |= as_terms(name, earned, variables.rewards | found.reward.keys())
        lost = lost or not name
        named.add(name)
    if not lost:
        for name in sorted(variables.rewards - named):
            faults.note(None, f"reward {name}", "no function", "a <Func> of it")


def _all(root: Element, tag: str) -> Iterable[Element]:
    return (function for section in root.all(tag) for function in section.children)


class _Function:
    """One ``CondProb`` or ``Func``."""

    def __init__(
        self,
        element: Element,
        parents: dict[str, Variable],
        declared: Declared,
        lines: Lines,
        faults: FaultList,
    ) -> None:
        self.element, self.known, self.lines, self.faults = element, parents, lines, faults
        self.declared = declared
        self.stamp = lines.stamp(element.line)

    def has_parts(self, faults: FaultList) -> bool:
        """Note missing parts."""
        missing = [tag for tag in ("Var", "Parent", "Parameter") if len(self.element.all(tag)) != 1]
        for tag in () if self.element.foreign else missing:
            faults.note(self.stamp, f"<{self.element.tag}>", f"{len(self.element.all(tag))} <{tag}>", "one")
        return not missing

    def variables(self, tag: str, known: dict[str, Variable]) -> list[Variable] | None:
        """The variables that a part lists; ``null`` or nothing for none."""
        part = self.element.first(tag)
        if part is None:
            return []
        if tag == "Parent" and whole(part.text) in ("", "null"):
            return []
        return named(part, known, self.declared, self.lines, self.faults)

    def distributions(self, children: list[Variable], kind: str) -> dict[str, Factor]:
        """A distribution for each of the function's variables, by the state's or observation's own name."""
        parents = self.variables("Parent", self.known)
        if parents is None:
            return {}
        scope = [*parents, *children]
        where = f"{kind} of {', '.join(child.name for child in children)}"
        layers = self._layers(scope, children, where) if len(set(scope)) == len(scope) else None
        if layers is None:
            if len(set(scope)) != len(scope):
                self.faults.note(self.stamp, where, "a variable that is its own parent", "other parents")
            return {}
        if len(children) == 1:
            factor = as_distribution(layers, scope, children[0], where, self.faults)
            return {} if factor is None else {children[0].now.name: factor}
        found = chained(layers, parents, children, where, self.stamp, self.faults, tied=kind != "observation")
        return {child.now.name: factor for child, factor in found.items()}

    def reward(self, before: Iterable[str]) -> str:
        """The reward's name, empty after a fault."""
        part = self.element.first("Var")
        name = whole(part.text) if part is not None else ""
        rewards = self.declared.rewards
        if name not in rewards:
            if self.declared.complete and not (part is None and self.element.foreign):
                expected = f"the name of a <RewardVar>{near(name, rewards)}"
                self.faults.note(self.stamp, "<Var>", shortened(name), expected)
            return ""
        if name in before:
            self.faults.note(self.stamp, "<Var>", f"a second function of {name}", "one")
            return ""
        return name

    def value(self, name: str) -> tuple[Factor, ...] | None:
        """The reward as a sum of factors."""
        parents = self.variables("Parent", self.known)
        if parents is None:
            return None
        where = f"reward {name}"
        layers = self._layers(parents, [], where)
        return None if layers is None else as_reward(layers, parents, where, self.faults)

    def _layers(self, scope: list[Variable], children: list[Variable], where: str) -> Layers | None:
        """What is said of each place; ``None`` where nothing can be said of any."""
        (parameter,) = self.element.all("Parameter")
        kind = whole(parameter.attributes.get("type", "TBL"))
        try:
            layers = Layers([variable.size for variable in scope])
        except TooLarge as problem:
            self.faults.note(self.stamp, where, str(problem), "fewer parents")
            return None
        if kind == "TBL":
            read_table(parameter, layers, scope, children, self.lines, self.faults)
        elif kind == "DD":
            names = [self._name(variable) for variable in scope]
            read_diagram(parameter, layers, names, scope, children, self.lines, self.faults)
        else:
            self.faults.note(self.lines.stamp(parameter.line), where, f"type={shortened(kind)}", "'TBL' or 'DD'")
            return None
        if parameter.foreign:
            layers.doubts.add_everything(self.lines.stamp(parameter.line))
        return layers

    def _name(self, variable: Variable) -> str:
        return next(name for name, known in self.known.items() if known == variable)
