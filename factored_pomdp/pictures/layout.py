"""Where everything in a picture of a model stands; lengths in inches, y upwards.

Columns from left to right: state variables now, actions (and what is earned from both), state variables next, what is
observed, what is earned from that. Bands stand one below the other; what they share stands above them, or at the
height of what it depends on.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from factored_pomdp.pictures.parts import Band, Edge, Node, Parts

__all__ = ["Box", "Layout", "Plate", "laid_out"]

_NOW, _BETWEEN, _NEXT, _SEEN, _WORTH = 0.0, 1.75, 3.5, 5.3, 6.9
_ROW, _HALF_ROW, _BESIDE = 0.78, 0.66, 1.45
_MARGIN, _CAPTION, _GAP = 0.2, 0.26, 0.3
Reach = tuple[float, float, float, float]
"""Left, right, bottom, top."""

_BENDS = tuple(sign * bend / 100 for bend in range(0, 65, 4) for sign in (1, -1))


@dataclass(frozen=True)
class Box:
    """A node's centre, size and the lines of its label; ``power`` is 1 for a diamond, 2 for an oval."""

    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]
    power: float = 2.0

    @property
    def reach(self) -> Reach:
        half, tall = self.width / 2, self.height / 2
        return self.x - half, self.x + half, self.y - tall, self.y + tall


@dataclass(frozen=True)
class Plate:
    """A frame around a band that stands for several."""

    left: float
    right: float
    bottom: float
    top: float
    caption: str

    @property
    def reach(self) -> Reach:
        return self.left, self.right, self.bottom, self.top


@dataclass(eq=False)
class Layout:
    """Boxes by key, plates, and how far each edge bends aside (in the sense of matplotlib's ``arc3``)."""

    boxes: dict[str, Box] = field(default_factory=dict)
    plates: list[Plate] = field(default_factory=list)
    bends: dict[Edge, float] = field(default_factory=dict)

    @property
    def slices(self) -> tuple[float, float]:
        """Where the columns of both slices stand."""
        return _NOW, _NEXT

    @property
    def reaches(self) -> list[Reach]:
        """What each box and plate takes up."""
        return [box.reach for box in self.boxes.values()] + [plate.reach for plate in self.plates]

    @property
    def extent(self) -> Reach:
        """What all together take up."""
        lefts, rights, bottoms, tops = zip(*self.reaches, strict=True)
        return min(lefts), max(rights), min(bottoms), max(tops)


def laid_out(parts: Parts) -> Layout:
    """Places for all nodes, plates around bands, bends around what stands in the way."""
    layout = Layout()
    parents: dict[str, list[str]] = {}
    for edge in parts.edges:
        parents.setdefault(edge.end, []).append(edge.start)
    top = 0.0
    for band in parts.bands:
        top = _place_band(layout, band, parts, parents, top) - _GAP
    _place_shared(layout, parts, parents, top)
    for edge in parts.edges:
        layout.bends[edge] = _bend(layout, edge)
    return layout


def _place_band(layout: Layout, band: Band, parts: Parts, parents: dict[str, list[str]], top: float) -> float:
    """Put a band below ``top``; returns its lower end."""
    above: dict[str, list[Node]] = {row: [] for row in band.rows}
    below: dict[str, list[Node]] = {row: [] for row in band.rows}
    follows: list[Node] = []
    for node in band.others:
        if node.kind == "action":
            above[_row_of(node, band, parts.edges)].append(node)
        elif node.kind == "reward" and not _reads_what_follows(node, parts, parents):
            own = [name for name in parents.get(node.key, []) if name in below]
            below[own[-1] if own else band.rows[-1]].append(node)
        else:
            follows.append(node)
    start = y = top - (_MARGIN if band.in_a_plate else 0.0)
    keys = [*band.rows, *(f"{row}.next" for row in band.rows), *(node.key for node in band.others)]
    for row in band.rows:
        y = _line(layout, above[row], y)
        y -= _ROW / 2
        layout.boxes[row] = _box(parts.nodes[row], _NOW, y)
        layout.boxes[f"{row}.next"] = _box(parts.nodes[f"{row}.next"], _NEXT, y)
        y = _line(layout, below[row], y - _ROW / 2)
    y = min(y, _column(layout, follows, parents, start, y))
    if band.in_a_plate:
        y -= _CAPTION + 0.04
        reaches = [layout.boxes[key].reach for key in keys]
        left, right = min(reach[0] for reach in reaches) - _MARGIN, max(reach[1] for reach in reaches) + _MARGIN
        layout.plates.append(Plate(left, right, y, top, _caption(band)))
    return y


def _line(layout: Layout, nodes: list[Node], top: float) -> float:
    """Put nodes side by side between the two slices, two a line; returns the lower end."""
    for first in range(0, len(nodes), 2):
        pair = nodes[first : first + 2]
        for place, node in enumerate(pair):
            x = _BETWEEN + (place - (len(pair) - 1) / 2) * _BESIDE
            layout.boxes[node.key] = _box(node, x, top - _HALF_ROW / 2)
        top -= _HALF_ROW
    return top


def _column(layout: Layout, nodes: list[Node], parents: dict[str, list[str]], top: float, bottom: float) -> float:
    """Put nodes at the height of what they depend on, observations left of rewards; returns the lower end."""
    lowest = bottom
    for x, kinds in ((_SEEN, ("observation", "end")), (_WORTH, ("reward",))):
        listed = [(_height(layout, node, parents, (top + bottom) / 2), node) for node in nodes if node.kind in kinds]
        free = top
        for height, node in sorted(listed, key=lambda entry: -entry[0]):
            y = min(height, free - _HALF_ROW / 2)
            layout.boxes[node.key] = _box(node, x, y)
            free = y - _HALF_ROW / 2
        lowest = min(lowest, free) if listed else lowest
    return lowest


def _place_shared(layout: Layout, parts: Parts, parents: dict[str, list[str]], bottom: float) -> None:
    """Actions above everything; the rest at the height of its parents, unless a plate is there."""
    actions = [node for node in parts.shared if node.kind == "action"]
    top = _GAP + _HALF_ROW * ((len(actions) + 1) // 2)
    _line(layout, actions, top)
    free = bottom
    for node in (node for node in parts.shared if node.kind != "action"):
        follows = node.kind != "reward" or _reads_what_follows(node, parts, parents)
        x = _BETWEEN if not follows else _WORTH if node.kind == "reward" else _SEEN
        box = _box(node, x, _height(layout, node, parents, free - _HALF_ROW / 2))
        if not follows or _is_taken(layout, box):
            box = _box(node, x, free - _HALF_ROW / 2)
            free -= _HALF_ROW
        layout.boxes[node.key] = box


def _is_taken(layout: Layout, box: Box) -> bool:
    left, right, bottom, top = box.reach
    return any(left < r[1] and r[0] < right and bottom < r[3] and r[2] < top for r in layout.reaches)


def _height(layout: Layout, node: Node, parents: dict[str, list[str]], otherwise: float) -> float:
    """Mean height of what a node depends on, actions aside."""
    boxes = [layout.boxes[name] for name in parents.get(node.key, []) if name in layout.boxes]
    heights = [box.y for box in boxes if box.x != _BETWEEN] or [box.y for box in boxes]
    return float(np.mean(heights)) if heights else otherwise


def _row_of(node: Node, band: Band, edges: list[Edge]) -> str:
    """The row whose next value an action has to do with; the first if there is none."""
    ends = {edge.end for edge in edges if edge.start == node.key}
    return next((row for row in band.rows if f"{row}.next" in ends), band.rows[0])


def _reads_what_follows(node: Node, parts: Parts, parents: dict[str, list[str]]) -> bool:
    read = [parts.nodes[name] for name in parents.get(node.key, [])]
    return any(parent.key.endswith(".next") or parent.kind == "observation" for parent in read)


def _box(node: Node, x: float, y: float) -> Box:
    lines = _lines(node.label)
    letters = max(len(line) for line in lines)
    if node.kind == "reward":
        return Box(x, y, max(0.62, 0.5 + 0.085 * letters), 0.5 + 0.08 * (len(lines) - 1), lines, 1.0)
    wide = 0.26 if node.kind == "action" else 0.36
    return Box(x, y, max(0.56, wide + 0.075 * letters), 0.36 + 0.12 * (len(lines) - 1), lines)


def _lines(label: str, most: int = 11) -> tuple[str, ...]:
    """A long label in two lines, parted at a dot if there is one, else at a blank or hyphen near its middle."""
    for letters in (".", " -_"):
        marks = [place + 1 for place, letter in enumerate(label[:-1]) if letter in letters]
        if len(label) > most and marks:
            at = min(marks, key=lambda place: abs(place - len(label) / 2))
            return label[:at].rstrip(), label[at:]
    return (label,)


def _caption(band: Band) -> str:
    if band.shape is None:
        return ""
    shown = f"× {band.shape.times}"
    if "ₖ" not in "".join(band.shape.labels.values()):
        names = ", ".join(band.shape.members[:3]) + (", …" if band.shape.times > 3 else "")
        shown = f"{names}: {shown}"
    return shown if band.shape.equal else f"{shown}, each with tables of its own"


def _bend(layout: Layout, edge: Edge) -> float:
    """The smallest bend that leads around what stands in the way."""
    ends = layout.boxes[edge.start], layout.boxes[edge.end]
    others = [box for key, box in layout.boxes.items() if key not in (edge.start, edge.end)]
    return min(_BENDS, key=lambda bend: (_hits(_curve(*ends, bend), others), abs(bend), -bend))


def _curve(start: Box, end: Box, bend: float) -> Float[np.ndarray, "points 2"]:
    """Points of the quadratic curve that matplotlib draws for ``arc3``."""
    one, other = np.array([start.x, start.y]), np.array([end.x, end.y])
    along = other - one
    control = (one + other) / 2 + bend * np.array([along[1], -along[0]])
    part = np.linspace(0, 1, 100)[:, None]
    return (1 - part) ** 2 * one + 2 * part * (1 - part) * control + part**2 * other


def _hits(points: Float[np.ndarray, "points 2"], boxes: list[Box]) -> int:
    """How many points of a curve lie in diamonds and ovals that are a little larger than the nodes."""
    if not boxes:
        return 0
    centres = np.array([[box.x, box.y] for box in boxes])
    reach = np.array([[box.width / 2 + 0.06, box.height / 2 + 0.06] for box in boxes])
    powers = np.array([[[box.power] for box in boxes]])
    inside = (np.abs((points[:, None] - centres) / reach) ** powers).sum(axis=2) < 1
    return int(inside.sum())
