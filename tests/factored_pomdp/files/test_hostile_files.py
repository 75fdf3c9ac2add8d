"""Files that mean harm, or nothing at all: refused with a message, and never at a great cost."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.files.cassandra.tokens import Tokens
from tests.factored_pomdp.files.test_cassandra_errors import GOOD as FLAT
from tests.factored_pomdp.files.test_pomdpx_errors import GOOD as XML

MOST_MEMORY = 3_000_000_000

HEAD = "discount: 0.9\nstates: {states}\nactions: {actions}\nobservations: {observations}\n"
BOMB = (
    "<!DOCTYPE pomdpx [<!ENTITY a0 'ha'>"
    + "".join(f"<!ENTITY a{k} '&a{k - 1};&a{k - 1};&a{k - 1};&a{k - 1};'>" for k in range(1, 20))
    + "]><pomdpx><Description>&a19;</Description></pomdpx>"
)
TEMPLATES = "".join(
    f'<SubDAGTemplate id="t{k}"><Node var="door_1"><Edge val="left"><SubDAG type="template" idref="t{k + 1}"/>'
    f'</Edge><Edge val="right"><SubDAG type="template" idref="t{k + 1}"/></Edge></Node></SubDAGTemplate>'
    for k in range(60)
)


@pytest.fixture(autouse=True)
def bounded_memory() -> object:
    """Let an allocation beyond the limit fail, so that a test cannot pass by swapping."""
    before = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_DATA, before)


def refused(path: Path, content: str | bytes) -> str:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(fp.FileError) as caught:
        fp.load(path)
    return str(caught.value)


@pytest.mark.example
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "discount: found nothing"),
        (b"\x00\x01\x02", "line 1: file: found a zero byte; expected a text file"),
        (b"\xff\xfe\xfd" * 1000, "expected a keyword"),
        (": " * 100_000, "expected a keyword"),
        ("T: " * 100_000, "expected 'states:' and 'actions:' before it"),
        ("states: " * 2_000, "states: found"),
        ("states: 100000000", "line 1: states: found '100000000'; expected 1 to 500,000"),
        ("states: " + "9" * 100_000, "states: found '9999"),
        ("actions: 3\nstates: " + "x " * 2_000, "states: found 'x' again"),
        (
            HEAD.format(states=40_000, actions=60_000, observations=60_000),
            "60000 × 40000 × 40000 × 60000 places; expected",
        ),
        (
            HEAD.format(states=40_000, actions=9, observations=2) + "T: * uniform\nT: * : 0 : 0 0\n",
            "1,600,000,000 entries",
        ),
        (HEAD.format(states=60_000, actions=900, observations=2) + "T: 0 : 0 : 0 1\n", "at most 20,000,000"),
        (
            HEAD.format(states=40_000, actions=9, observations=2) + "T: * identity\n" * 300,
            "observation of observation",
        ),
        (
            HEAD.format(states=9_000, actions=9, observations=2) + "T: 1 : 0 uniform\nT: 2 uniform\n" * 100,
            "entries or more that are not zero",
        ),
        (
            HEAD.format(states=3, actions=1, observations=2) + "T: 0 : 0\n" + "1 " * 50_000,
            "more numbers than expected",
        ),
        (
            HEAD.format(states=40_000, actions=2, observations=2)
            + "T: * identity\nO: * uniform\nR: * : * : * : * -1\n"
            + "".join(f"R: * : {k} : * : * 2\nR: * : * : {k} : * 3\n" for k in range(600)),
            "reward: found 1,648,000,000 entries or more that are not zero; 20,000,000 are allowed; expected numbers "
            "that hold for many places to depend on fewer variables, or fewer exceptions to them",
        ),
        ("states: " + "a" * 2_000_000, "a name of 2,000,000 characters; expected at most 1,000"),
        (FLAT + "T: " + "a" * 2_000_000 + " identity", "expected an action (there are 2) or *"),
        (
            HEAD.format(states=3, actions=1, observations=2) + "T: * " + "0.5 " * 2_000_000,
            "found many more numbers than expected",
        ),
        ("states: " + "".join(f"s{k} " for k in range(1_200_000)), "names; expected at most 500,000"),
        (FLAT[: len(FLAT) // 2], "found"),
    ],
)
def test_flat_files(tmp_path: Path, content: str | bytes, expected: str) -> None:
    message = refused(tmp_path / "bad.pomdp", content)
    assert expected in message
    assert len(message) < 10_000


@pytest.mark.example
def test_a_text_is_taken_apart_no_further_than_its_lists_allow() -> None:
    head = "states: 1500\nactions: 1\nobservations: 2\nT: * "
    whole = Tokens(head + "0 " * 1500**2 + "O: * uniform")
    assert (whole.cut, len(whole)) == (False, 1500**2 + 16)
    cut = Tokens(head + "0 " * (1500**2 + 1_200_000))
    assert cut.cut
    assert 1500**2 + 12 < len(cut) < 1500**2 + 40


@pytest.mark.example
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "no well-formed XML"),
        (b"\x00\x01\x02", "no well-formed XML"),
        (BOMB, "found a declaration of the entity 'a0'; expected a file without entities"),
        (
            "<!DOCTYPE pomdpx [<!ENTITY x SYSTEM 'file:///etc/hostname'>]><pomdpx>&x;</pomdpx>",
            "declaration of the entity",
        ),
        ("<?xml version='1.0' encoding='klingon'?><pomdpx/>", "found"),
        ("<pomdpx>" + "<Variable>" * 100_000, "elements nested deeper than 200"),
        ("<pomdpx>" + "<Nonsense/>" * 3_000 + "</pomdpx>", "found <Nonsense>"),
        ("<pomdpx/>", "found no <Variable>"),
        (XML.replace("<ValueEnum>l r</ValueEnum>", "<NumValues>100000000</NumValues>"), "NumValues '100000000'"),
        (
            XML.replace("</DAG>", "</DAG>" + TEMPLATES).replace('idref="other"', 'idref="t0"'),
            "a second time on one path",
        ),
        (
            XML.replace('<SubDAG type="uniform" var="sound"/>', '<SubDAG type="template" idref="other"/>'),
            "holds itself",
        ),
        (XML.replace("<Parent>act</Parent>", "<Parent>" + "act " * 2_000 + "</Parent>"), "every variable once"),
        (XML[: len(XML) // 2], "no well-formed XML"),
    ],
)
def test_xml_files(tmp_path: Path, content: str | bytes, expected: str) -> None:
    message = refused(tmp_path / "bad.pomdpx", content)
    assert expected in message
    assert len(message) < 10_000


@pytest.mark.example
def test_a_diagram_whose_paths_multiply_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("factored_pomdp.files.pomdpx.diagram.MOST_STEPS", 1_000)
    names = [f"x{k}" for k in range(40)]
    variables = "".join(f'<ActionVar vname="{name}"><NumValues>2</NumValues></ActionVar>' for name in names)
    templates = "".join(
        f'<SubDAGTemplate id="{name}"><Node var="{name}">'
        + "".join(f'<Edge val="a{v}"><SubDAG type="template" idref="x{k + 1}"/></Edge>' for v in (0, 1))
        + "</Node></SubDAGTemplate>"
        for k, name in enumerate(names)
    )
    text = XML.replace('<ActionVar vname="act">', variables + '<ActionVar vname="act">')
    text = text.replace("<Parent>act</Parent>", f"<Parent>{' '.join(names)}</Parent>")
    begin = text.index("<Parameter><Entry><Instance>listen</Instance>")
    end = text.index("</Func>")
    diagram = '<Parameter type="DD"><DAG><SubDAG type="template" idref="x0"/></DAG>' + templates
    last = '<SubDAGTemplate id="x40"><Terminal>1</Terminal></SubDAGTemplate></Parameter>'
    message = refused(tmp_path / "paths.pomdpx", text[:begin] + diagram + last + text[end:])
    assert "more than 1,000 steps on all paths" in message


def _mutated(text: str) -> st.SearchStrategy[bytes]:
    """A good file with parts cut out, doubled or overwritten."""

    def apply(edits: list[tuple[int, int, bytes]]) -> bytes:
        content = text.encode()
        for begin, length, inserted in edits:
            begin %= len(content) + 1
            content = content[:begin] + inserted + content[begin + length :]
        return content

    scraps = st.sampled_from(
        [b"", b":", b" ", b"*", b"-", b"T", b"0.5", b"1e400", b"nan", b"<", b">", b'"', b"\xff", b"&"]
    )
    edits = st.tuples(st.integers(0, len(text)), st.integers(0, 30), st.one_of(scraps, st.binary(max_size=8)))
    return st.lists(edits, min_size=1, max_size=4).map(apply)


@pytest.mark.property
@settings(max_examples=80)
@given(st.one_of(_mutated(FLAT), st.binary(max_size=200)))
def test_any_flat_file_loads_or_is_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    _loads_or_is_refused(tmp_path_factory.getbasetemp() / "fuzz.pomdp", content)


@pytest.mark.property
@settings(max_examples=80)
@given(st.one_of(_mutated(XML), st.binary(max_size=200)))
def test_any_xml_file_loads_or_is_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    _loads_or_is_refused(tmp_path_factory.getbasetemp() / "fuzz.pomdpx", content)


def _loads_or_is_refused(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    loaded, faults = None, ()
    try:
        loaded = fp.load(path)
    except fp.FileError as problem:
        faults = problem.faults
    assert (loaded is None) == bool(faults)
    assert all(
        fault.line is None or 1 <= fault.line <= content.count(b"\n") + content.count(b"\r") + 1 for fault in faults
    )
