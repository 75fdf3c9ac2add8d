"""What a picture of a model shows: variables of two slices, who depends on whom, blocks of one shape drawn once.

Parents without numeric influence are left out, as in `fp.decompose`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

from factored_pomdp.factors import Factor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.pictures.shapes import Shape, dependences, shapes_of
from factored_pomdp.structure import GOES_ON, Join, Structure, structure_of

__all__ = ["Band", "Edge", "Kind", "Node", "Parts", "parts_of"]

Kind = Literal["hidden", "known", "action", "observation", "reward", "end"]


@dataclass(frozen=True)
class Node:
    """A variable of one slice, a reward, or the end of an episode.

    Attributes
    ----------
    key : str
        The variable's name (``x.next`` in the second slice); a reward's behind ``reward``.
    """

    key: str
    kind: Kind
    label: str


@dataclass(frozen=True)
class Edge:
    """A dependence; ``tie`` is the kind of tie that it is part of, or empty. An initial tie has no direction."""

    start: str
    end: str
    tie: str = ""


@dataclass(eq=False)
class Band:
    """What belongs together: a known variable, or a block, drawn once for all of its shape.

    Attributes
    ----------
    rows : list of str
        State variables, one a row.
    shape : Shape or None
        That of a block.
    others : list of Node
        Actions, observations, rewards that nothing else has to do with.
    """

    rows: list[str]
    shape: Shape | None = None
    others: list[Node] = field(default_factory=list)

    @property
    def in_a_plate(self) -> bool:
        return self.shape is not None and self.shape.times > 1


@dataclass(frozen=True, eq=False)
class Parts:
    """Everything to be drawn; ``shared`` belongs to several bands, or to none."""

    bands: list[Band]
    shared: list[Node]
    nodes: dict[str, Node]
    edges: list[Edge]


def parts_of(model: FactoredPOMDP) -> Parts:
    """Nodes, edges and bands of a model."""
    structure = structure_of(model)
    shapes = shapes_of(structure.blocks)
    plated = {name for shape in shapes if shape.times > 1 for name in shape.own}
    bands = [Band([name]) for name in structure.known if name not in plated]
    for shape in shapes:
        own = [name for name in structure.known if shape.times > 1 and name in shape.labels]
        bands.append(Band([*own, *shape.pattern.names], shape))
    kinds, parents, homes = _dependences(structure, bands)
    nodes = _nodes(model, structure, bands, kinds, parents)
    for key, node in nodes.items():
        if node.kind in ("action", "observation", "reward", "end"):
            at = homes.get(key, set())
            band = bands[next(iter(at))] if len(at) == 1 else None
            if band is not None and (not band.in_a_plate or (band.shape is not None and key in band.shape.labels)):
                band.others.append(node)
    housed = {node.key for band in bands for node in band.others}
    states = {name for band in bands for row in band.rows for name in (row, f"{row}.next")}
    shared = [node for key, node in nodes.items() if key not in housed and key not in states]
    return Parts(bands, shared, nodes, _edges(structure, nodes, parents))


def _dependences(
    structure: Structure, bands: list[Band]
) -> tuple[dict[str, Kind], dict[str, list[str]], dict[str, set[int]]]:
    """Kind and parents of everything that depends on something, and the bands that mention a name."""
    kinds: dict[str, Kind] = {}
    parents: dict[str, list[str]] = {}
    homes: dict[str, set[int]] = {}

    def note(band: int, key: str, kind: Kind, factor: Factor) -> None:
        kinds[key] = kind
        names = [name for name in factor.names if name not in (key, GOES_ON.name)]
        parents[key] = list(dict.fromkeys([*parents.get(key, []), *names]))
        for name in (key, *names):
            homes.setdefault(name, set()).add(band)

    place = {row: number for number, band in enumerate(bands) for row in band.rows}
    for number, band in enumerate(bands):
        for row in band.rows:
            if f"{row}.next" in structure.laws:
                note(number, f"{row}.next", "known", structure.laws[f"{row}.next"])
        for kind, name, factor in dependences(band.shape.pattern) if band.shape is not None else ():
            if kind == "reward":
                note(number, f"reward {name}", "reward", factor)
            elif kind == "transition" or name in structure.known:
                note(number, f"{name}.next", "hidden" if kind == "transition" else "known", factor)
            else:
                note(number, name, "end" if name == GOES_ON.name else "observation", factor)

    loose: list[tuple[str, Kind, Factor]] = [
        (name, "observation", law) for name, law in structure.laws.items() if not name.endswith(".next")
    ]
    loose += [(f"reward {name}", "reward", factor) for name, factor in structure.free_rewards]
    if structure.running is not None:
        loose.append((GOES_ON.name, "end", structure.running))
    elsewhere = {name for band in bands if band.in_a_plate and band.shape for name in band.shape.own}
    for key, kind, factor in loose:
        if key not in elsewhere and all(n.removesuffix(".next") not in elsewhere - place.keys() for n in factor.names):
            states = [place[variable.now.name] for variable in factor.scope if variable.now.name in place]
            others = [band for name in factor.names for band in homes.get(name, ())]
            note((states or others or [0])[0], key, kind, factor)
    return kinds, parents, homes


def _nodes(
    model: FactoredPOMDP,
    structure: Structure,
    bands: list[Band],
    kinds: dict[str, Kind],
    parents: dict[str, list[str]],
) -> dict[str, Node]:
    """Every variable that is drawn, and every reward that depends on something."""
    labels = {
        key: label for band in bands if band.in_a_plate and band.shape for key, label in band.shape.labels.items()
    }
    actions = {variable.name for variable in model.actions}
    others = {name for band in bands if band.in_a_plate and band.shape for name in band.shape.own} - labels.keys()
    nodes = {}
    for band in bands:
        for row in band.rows:
            kind: Kind = "known" if row in structure.known else "hidden"
            nodes[row] = Node(row, kind, labels.get(row, row))
            nodes[f"{row}.next"] = Node(f"{row}.next", kind, labels.get(row, row) + "′")
    for name in [variable.name for variable in model.actions if variable.name not in others]:
        nodes[name] = Node(name, "action", labels.get(name, name))
    for key, kind in kinds.items():
        if key not in nodes and key not in actions and (parents[key] or kind != "reward"):
            shown = "end?" if kind == "end" else labels.get(key, key).removeprefix("reward ")
            nodes[key] = Node(key, kind, shown)
    return nodes


def _edges(structure: Structure, nodes: dict[str, Node], parents: dict[str, list[str]]) -> list[Edge]:
    thing_of = {name: number for number, names in enumerate(structure.things) for name in names}
    edges = {(start, end): "" for end, starts in parents.items() for start in starts if {start, end} <= nodes.keys()}
    lines: list[Edge] = []
    for join in structure.joins:
        if join.kind == "initial":
            lines += _initial(join, structure, nodes)
            continue
        end = {"terminal": GOES_ON.name, "reward": join.factor}.get(join.kind, join.factor.partition(" of ")[2])
        own = thing_of.get(end.removesuffix(".next"))
        for start in join.table.names:
            thing = thing_of.get(start.removesuffix(".next"))
            if (start, end) not in edges:
                continue
            if thing not in (None, own) or (thing is None and nodes[start].kind == "observation"):
                edges[start, end] = join.kind
    return [Edge(start, end, tie) for (start, end), tie in edges.items()] + lines


def _initial(join: Join, structure: Structure, nodes: dict[str, Node]) -> Iterable[Edge]:
    """Lines between the things that start out tied, one after the other."""
    heads = [next(n for n in join.table.names if n in structure.things[number]) for number in join.things]
    return [Edge(one, other, "initial") for one, other in pairwise(heads) if {one, other} <= nodes.keys()]
