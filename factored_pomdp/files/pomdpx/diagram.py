"""A function given as ``DD``: a decision diagram whose paths fix variables and end in a number.

Variables that a path does not fix may have any value; paths that are not drawn end in zero. A ``SubDAG`` stands for a
distribution of one variable: ``uniform``, ``deterministic`` (one value), ``persistent`` (the value it had before), or
for a ``template`` drawn elsewhere. As templates may stand in templates, the paths are counted while they are walked.
"""

from __future__ import annotations

from collections.abc import Sequence

from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.pomdpx.tree import DEEPEST, Element, Lines
from factored_pomdp.files.pomdpx.variables import whole
from factored_pomdp.files.values import all_numbers, lookup, near
from factored_pomdp.variables import Variable

__all__ = ["MOST_STEPS", "read_diagram"]

MOST_STEPS = 1_000_000
"""Nodes and ends that the paths of one diagram may pass in all."""


def read_diagram(
    parameter: Element,
    layers: Layers,
    names: Sequence[str],
    scope: Sequence[Variable],
    children: Sequence[Variable],
    lines: Lines,
    faults: FaultList,
) -> None:
    """Lay a diagram's paths into ``layers``.

    Parameters
    ----------
    names, scope : sequences
        Names in the file, and variables, of the layers' axes.
    children : sequence of Variable
        The function's own variables; none for a reward.
    """
    roots = parameter.all("DAG")
    for wrong in parameter.all("Entry"):
        faults.note(lines.stamp(wrong.line), "<Parameter type='DD'>", "<Entry>", "<DAG>")
    if len(roots) != 1:
        stamp = lines.stamp(parameter.line)
        layers.doubts.add_everything(stamp)
        if not parameter.foreign:
            faults.note(stamp, "<Parameter type='DD'>", f"{len(roots)} <DAG>", "one")
        return
    templates = {whole(found.attributes.get("id", "")): found for found in parameter.all("SubDAGTemplate")}
    _Walk(layers, names, scope, children, templates, lines, faults).from_(roots[0])


_MOST_LEFT = 100
"""Values of a variable that are doubted one by one."""

_Place = tuple[Element, list[int], int]
"""An element that holds others, positions of the variables fixed on the way to it (-1: not fixed), the way's length."""


class _Walk:
    def __init__(
        self,
        layers: Layers,
        names: Sequence[str],
        scope: Sequence[Variable],
        children: Sequence[Variable],
        templates: dict[str, Element],
        lines: Lines,
        faults: FaultList,
    ) -> None:
        self.layers, self.scope, self.children, self.templates = layers, scope, children, templates
        self.lines, self.faults = lines, faults
        self._axes = {name: axis for axis, name in enumerate(names)}
        self._positions = [lookup(variable) for variable in scope]
        self._steps = 0
        self._told: set[tuple[int, str]] = set()

    def from_(self, root: Element) -> None:
        """Walk all paths that begin at an element."""
        waiting: list[_Place] = [(root, [-1] * len(self.scope), 0)]
        while waiting and not self.faults.full:
            element, coordinates, length = waiting.pop()
            self._steps += 1
            if self._steps > MOST_STEPS:
                nowhere = [-1] * len(self.scope)
                self._note(element, nowhere, f"more than {MOST_STEPS:,} steps on all paths", "a smaller diagram")
                return
            if length > DEEPEST:
                found = f"paths longer than {DEEPEST}, or a template that holds itself"
                self._note(element, coordinates, found, "shorter paths")
                continue
            waiting += reversed(self._inside(element, coordinates, length))

    def _inside(self, element: Element, coordinates: list[int], length: int) -> list[_Place]:
        """Lay down the end that a DAG, a template or an edge holds, or tell where the paths go on."""
        if len(element.children) != 1:
            self._note(element, coordinates, f"{len(element.children)} elements", "one <Node>, <SubDAG> or <Terminal>")
            return []
        (only,) = element.children
        if only.tag == "Node":
            return self._node(only, coordinates, length)
        if only.tag == "SubDAG" and only.attributes.get("type", "").strip() == "template":
            wanted = whole(only.attributes.get("idref", ""))
            if wanted in self.templates:
                return [(self.templates[wanted], coordinates, length + 1)]
            self._note(
                only, coordinates, f"idref={shortened(wanted)}", f"a template's id{near(wanted, self.templates)}"
            )
        elif only.tag == "SubDAG":
            self._distribution(only, coordinates)
        else:
            numbers = all_numbers(only.text.split())
            if numbers is None or len(numbers) != 1:
                self._note(only, coordinates, shortened(only.text.strip()), "a finite number")
            else:
                self._scalar(coordinates, float(numbers[0]), only)
        return []

    def _node(self, node: Element, coordinates: list[int], length: int) -> list[_Place]:
        axis = self._axis(node, coordinates)
        if axis is None:
            return []
        ways: list[_Place] = []
        drawn = {self._positions[axis].get(whole(edge.attributes.get("val", ""))) for edge in node.children}
        others = [position for position in range(min(self.scope[axis].size, _MOST_LEFT)) if position not in drawn]
        if self.scope[axis].size > _MOST_LEFT:
            others = [-1]
        left = [[*coordinates[:axis], position, *coordinates[axis + 1 :]] for position in others]
        for edge in node.children:
            position = self._position(edge, axis, left)
            if position is not None:
                ways.append((edge, [*coordinates[:axis], position, *coordinates[axis + 1 :]], length + 1))
        return ways

    def _distribution(self, end: Element, coordinates: list[int]) -> None:
        kind = end.attributes.get("type", "").strip()
        if kind not in ("uniform", "deterministic", "persistent"):
            self._note(end, coordinates, f"type={shortened(kind)}", "uniform, deterministic, persistent or template")
            return
        axis = self._axis(end, coordinates)
        if axis is None:
            return
        variable = self.scope[axis]
        if variable not in self.children:
            self._note(
                end, coordinates, f"a distribution of {variable.name}", "of a variable that the function is about"
            )
        elif kind == "uniform":
            self._scalar(coordinates, 1 / variable.size, end)
        elif kind == "deterministic":
            position = self._position(end, axis, [coordinates])
            if position is not None:
                self._scalar([*coordinates[:axis], position, *coordinates[axis + 1 :]], 1.0, end)
        else:
            self._persistent(end, coordinates, axis)

    def _persistent(self, end: Element, coordinates: list[int], axis: int) -> None:
        variable = self.scope[axis]
        if not variable.is_next or variable.now not in self.scope:
            self._note(
                end, coordinates, f"persistent {variable.name}", "a variable whose value before is among the parents"
            )
            return
        before = self.scope.index(variable.now)
        if coordinates[before] >= 0:
            self._scalar([*coordinates[:axis], coordinates[before], *coordinates[axis + 1 :]], 1.0, end)
        else:
            self.layers.diagonal(coordinates, (before, axis), self.lines.stamp(end.line))

    def _axis(self, element: Element, coordinates: list[int]) -> int | None:
        """Which axis an element's variable has, if that is not fixed yet."""
        name = whole(element.attributes.get("var", ""))
        axis = self._axes.get(name)
        if axis is None:
            self._note(
                element, coordinates, f"var={shortened(name)}", f"a variable of the function{near(name, self._axes)}"
            )
        elif coordinates[axis] >= 0:
            self._note(element, coordinates, f"{name} a second time on one path", "every variable once")
            return None
        return axis

    def _position(self, element: Element, axis: int, doubted: Sequence[Sequence[int]]) -> int | None:
        """Where a value is on an axis; if there is none, the boxes that may have been meant are doubted."""
        value = whole(element.attributes.get("val", ""))
        position = self._positions[axis].get(value)
        if position is None or position < 0:
            expected = f"a value of {self.scope[axis].name}{near(value, self.scope[axis].values)}"
            for box in doubted or [[-1] * len(self.scope)]:
                self._note(element, box, f"val={shortened(value)}", expected)
            return None
        return position

    def _scalar(self, coordinates: list[int], number: float, element: Element) -> None:
        self.layers.scalar(coordinates, number, self.lines.stamp(element.line))

    def _note(self, element: Element, coordinates: Sequence[int], found: str, expected: str) -> None:
        """Doubt a box; note a fault once for each place, however many paths lead there."""
        stamp = self.lines.stamp(element.line)
        self.layers.doubts.add(coordinates, stamp)
        if (id(element), found) not in self._told:
            self._told.add((id(element), found))
            self.faults.note(stamp, f"<{element.tag}>", found, expected)
