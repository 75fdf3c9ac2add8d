"""What a picture of a model shows: nodes, edges, plates, ties; and that nothing covers anything else."""

from __future__ import annotations

import itertools

import pytest

import factored_pomdp as fp
from factored_pomdp.errors import TooLarge
from factored_pomdp.pictures.graph import draw_graph
from factored_pomdp.pictures.layout import laid_out
from factored_pomdp.pictures.parts import Edge, parts_of
from factored_pomdp.pictures.shapes import shapes_of
from factored_pomdp.structure import structure_of

MODELS = [
    ("tiger", {}),
    ("machine-repair", {"machines": 3}),
    ("machine-repair", {"machines": 4, "coupled": True}),
    ("rocksample", {}),
    ("sysadmin", {"reboot_cost": 1.0}),
    ("valves", {}),
    ("valves", {"tie": False}),
    ("surveillance", {"site": "tiny", "targets": 3}),
]


def edges(model: fp.FactoredPOMDP) -> set[tuple[str, str]]:
    return {(edge.start, edge.end) for edge in parts_of(model).edges}


@pytest.mark.example
def test_tiger_has_six_edges() -> None:
    parts = parts_of(fp.domain("tiger"))
    assert {key: node.kind for key, node in parts.nodes.items()} == {
        "tiger": "hidden",
        "tiger.next": "hidden",
        "act": "action",
        "heard": "observation",
        "reward reward": "reward",
    }
    assert {(edge.start, edge.end) for edge in parts.edges} == {
        ("tiger", "tiger.next"),
        ("act", "tiger.next"),
        ("tiger.next", "heard"),
        ("act", "heard"),
        ("tiger", "reward reward"),
        ("act", "reward reward"),
    }
    assert not any(edge.tie for edge in parts.edges)


@pytest.mark.example
def test_equal_blocks_stand_once_in_a_plate() -> None:
    parts = parts_of(fp.domain("machine-repair", machines=20))
    (band,) = parts.bands
    assert band.in_a_plate
    assert (band.shape.times, band.shape.equal) == (20, True)
    assert {node.label for node in parts.nodes.values()} == {
        "machineₖ",
        "machineₖ′",
        "machineₖ.hand",
        "machineₖ.part",
        "machineₖ.earns",
    }
    assert parts.shared == []
    (plate,) = laid_out(parts).plates
    assert plate.caption == "× 20"


@pytest.mark.example
def test_rocks_share_their_shape_but_not_their_tables() -> None:
    parts = parts_of(fp.domain("rocksample"))
    assert [band.rows for band in parts.bands] == [["place"], ["rock1"]]
    assert {node.key for node in parts.shared} == {"act", "reading"}
    assert [plate.caption for plate in laid_out(parts).plates] == ["× 4, each with tables of its own"]
    assert parts.nodes["place"].kind == "known"
    ends = [key for key, node in parts.nodes.items() if node.kind == "end"]
    assert ("place.next", ends[0]) in edges(fp.domain("rocksample"))


@pytest.mark.example
def test_known_cameras_stand_by_themselves_and_targets_in_a_plate() -> None:
    parts = parts_of(fp.domain("surveillance", site="tiny", targets=3))
    known = [band.rows[0] for band in parts.bands if not band.in_a_plate]
    assert all(parts.nodes[row].kind == "known" for row in known)
    (targets,) = [band for band in parts.bands if band.in_a_plate]
    assert targets.shape.times == 3
    assert all((f"{row}.next", "target1.sighting") in edges(fp.domain("surveillance", targets=3)) for row in known)


@pytest.mark.example
def test_ties_are_marked_with_their_kind() -> None:
    marked = [edge for edge in parts_of(fp.domain("valves")).edges if edge.tie]
    assert set(marked) == {
        Edge("inlet.next", "gauge", "observation"),
        Edge("outlet.next", "gauge", "observation"),
    }
    ring = {edge for edge in parts_of(fp.domain("sysadmin", machines=3)).edges if edge.tie}
    assert ring == {
        Edge("machine3", "machine1.next", "transition"),
        Edge("machine1", "machine2.next", "transition"),
        Edge("machine2", "machine3.next", "transition"),
    }
    assert not any(edge.tie for edge in parts_of(fp.domain("valves", tie=False)).edges)


@pytest.mark.example
def test_initial_reward_and_terminal_ties() -> None:
    one, other, act = (fp.Variable(name, [0, 1]) for name in ("one", "other", "act"))
    common = {
        "states": [one, other],
        "actions": [act],
        "observations": [],
        "transition": {"one": lambda one: one, "other": lambda other: other},
        "observation": {},
    }
    apart = {"one": {0: 0.5, 1: 0.5}, "other": {0: 0.5, 1: 0.5}}
    tied = apart | {"other": fp.table("one", "other", values=[[0.9, 0.1], [0.1, 0.9]])}

    def both(one_next: int, other_next: int, act: int) -> float:
        return float(act * one_next * other_next)

    initially = parts_of(fp.FactoredPOMDP(**common, reward={}, initial=tied))
    assert [edge for edge in initially.edges if edge.tie] == [Edge("one", "other", "initial")]
    rewarded = parts_of(fp.FactoredPOMDP(**common, reward={"both": both}, initial=apart))
    assert {(edge.start, edge.tie) for edge in rewarded.edges if edge.end == "reward both"} == {
        ("one.next", "reward"),
        ("other.next", "reward"),
        ("act", ""),
    }
    ended = parts_of(fp.FactoredPOMDP(**common, reward={}, initial=apart, terminal=lambda one, other: one * other))
    (end,) = [node.key for node in ended.nodes.values() if node.kind == "end"]
    assert {edge for edge in ended.edges if edge.end == end} == {
        Edge("one.next", end, "terminal"),
        Edge("other.next", end, "terminal"),
    }


@pytest.mark.example
def test_things_without_numbers_are_named_in_the_caption() -> None:
    model = fp.domain("valves", tie=False)
    assert shapes_of(structure_of(model).blocks)[0].labels["inlet"] == "inlet"
    (plate,) = laid_out(parts_of(model)).plates
    assert plate.caption.startswith("inlet, outlet: × 2")


@pytest.mark.property
@pytest.mark.parametrize(("name", "options"), MODELS)
def test_no_two_nodes_overlap_and_plates_hold_their_own(name: str, options: dict) -> None:
    parts = parts_of(fp.domain(name, **options))
    layout = laid_out(parts)
    assert layout.boxes.keys() == parts.nodes.keys()
    for one, other in itertools.combinations(layout.boxes.values(), 2):
        left, right, bottom, top = one.reach
        assert not (
            left < other.reach[1] and other.reach[0] < right and bottom < other.reach[3] and other.reach[2] < top
        )
    plated = [band for band in parts.bands if band.in_a_plate]
    for band, plate in zip(plated, layout.plates, strict=True):
        inside = {key for row in band.rows for key in (row, f"{row}.next")} | {node.key for node in band.others}
        for key, box in layout.boxes.items():
            left, right, bottom, top = box.reach
            within = plate.left < left and right < plate.right and plate.bottom < bottom and top < plate.top
            assert within == (key in inside)


@pytest.mark.property
@pytest.mark.parametrize(("name", "options"), MODELS)
def test_edges_run_between_factors_scopes(name: str, options: dict) -> None:
    """Nothing is drawn that the model does not say."""
    model = fp.domain(name, **options)
    scopes = {f"{child}.next": set(factor.names) for child, factor in model.transition.items()}
    scopes |= {child: set(factor.names) for child, factor in model.observation.items()}
    scopes |= {f"reward {child}": set(factor.names) for child, factor in model.reward.items()}
    drawn = [edge for edge in parts_of(model).edges if edge.end in scopes]
    assert drawn
    assert all(edge.start in scopes[edge.end] for edge in drawn)


@pytest.mark.example
def test_the_figure_names_every_node() -> None:
    (axes,) = draw_graph(fp.domain("valves")).get_axes()
    shown = {text.get_text().replace("\n", "") for text in axes.texts}
    assert {"inlet", "inlet′", "mend", "gauge", "work", "observation tie", "now", "next"} <= shown
    assert "valves: 1 block; observation tie" in shown


@pytest.mark.example
def test_too_many_nodes_are_refused() -> None:
    with pytest.raises(TooLarge, match=r"the graph of machine-repair has 200 nodes; up to 150 are drawn"):
        draw_graph(fp.domain("machine-repair", machines=40, coupled=True))
