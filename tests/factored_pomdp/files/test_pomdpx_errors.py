"""Faulty ``.pomdpx`` files: all faults at once, each with its line, what was found and what would be right."""

from __future__ import annotations

from pathlib import Path

import pytest

import factored_pomdp as fp

GOOD = """<pomdpx version="1.0">
<Discount>0.95</Discount>
<Variable>
<StateVar vnamePrev="door_0" vnameCurr="door_1"><ValueEnum>left right</ValueEnum></StateVar>
<ObsVar vname="sound"><ValueEnum>l r</ValueEnum></ObsVar>
<ActionVar vname="act"><ValueEnum>listen open</ValueEnum></ActionVar>
<RewardVar vname="cost"/>
</Variable>
<InitialStateBelief><CondProb>
<Var>door_0</Var>
<Parent>null</Parent>
<Parameter><Entry><Instance>-</Instance><ProbTable>0.5 0.5</ProbTable></Entry></Parameter>
</CondProb></InitialStateBelief>
<StateTransitionFunction><CondProb>
<Var>door_1</Var>
<Parent>act door_0</Parent>
<Parameter type="TBL">
<Entry><Instance>listen - -</Instance><ProbTable>identity</ProbTable></Entry>
<Entry><Instance>open * -</Instance><ProbTable>0.5 0.5</ProbTable></Entry>
</Parameter>
</CondProb></StateTransitionFunction>
<ObsFunction><CondProb>
<Var>sound</Var>
<Parent>door_1</Parent>
<Parameter type="DD"><DAG><Node var="door_1">
<Edge val="left"><SubDAG type="deterministic" var="sound" val="l"/></Edge>
<Edge val="right"><SubDAG type="template" idref="other"/></Edge>
</Node></DAG>
<SubDAGTemplate id="other"><SubDAG type="uniform" var="sound"/></SubDAGTemplate></Parameter>
</CondProb></ObsFunction>
<RewardFunction><Func>
<Var>cost</Var>
<Parent>act</Parent>
<Parameter><Entry><Instance>listen</Instance><ValueTable>-1</ValueTable></Entry></Parameter>
</Func></RewardFunction>
</pomdpx>
"""


def faults(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "bad.pomdpx"
    path.write_text(text)
    with pytest.raises(fp.FileError) as caught:
        fp.load(path)
    return [str(fault) for fault in caught.value.faults]


@pytest.mark.example
def test_the_good_file_is_good(tmp_path: Path) -> None:
    path = tmp_path / "good.pomdpx"
    path.write_text(GOOD)
    model = fp.load(path)
    assert model.observation["sound"].dense().array.tolist() == [[1, 0], [0.5, 0.5]]


@pytest.mark.example
@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("<Discount>0.95</Discount>", "", "line 1: <Discount>: found nothing; expected a number in [0, 1]"),
        ("0.95", "2", "line 2: <Discount>: found '2'; expected a number in [0, 1]"),
        ("vnameCurr", "vnameNext", "line 4: <StateVar>: found no vnameCurr; expected vnameCurr, the variable's name"),
        ("left right", "left left", "line 4: <StateVar> 'door_0': found 'left' more than once"),
        (
            "<ValueEnum>l r</ValueEnum>",
            "<NumValues>many</NumValues>",
            "line 5: <ObsVar> 'sound': found NumValues 'many'",
        ),
        ("<ValueEnum>l r</ValueEnum>", "", "line 5: <ObsVar> 'sound': found neither ValueEnum nor NumValues"),
        ('vname="act"', 'vname="sound"', "line 6: <ActionVar>: found 'sound' again; expected every name once"),
        (
            "RewardVar",
            "RewardVra",
            "line 7: in <Variable>: found <RewardVra>; expected an element of the format (did you",
        ),
        (
            "<Var>door_0",
            "<Var>dor_0",
            "line 10: <Var>: found 'dor_0'; expected a variable that may stand here (did you",
        ),
        (
            "0.5 0.5</ProbTable></Entry></Parameter>",
            "0.5 0.4</ProbTable></Entry></Parameter>",
            "line 12: initial belief",
        ),
        ("<Parent>act door_0</Parent>", "", "line 14: <CondProb>: found 0 <Parent>; expected one"),
        (
            "listen - -",
            "listen -",
            "line 18: <Instance>: found 2 words; expected 3, one for each of: act door door.next",
        ),
        ("listen - -", "hear - -", "line 18: <Instance>: found 'hear'; expected a value of act, * or - (there are"),
        ("listen - -", "listen * -", "line 18: <ProbTable>: found identity; expected identity only where two - of"),
        (
            "0.5 0.5</ProbTable></Entry>\n",
            "0.5</ProbTable></Entry>\n",
            "line 19: <ProbTable>: found 1 numbers; expected 2",
        ),
        (
            "0.5 0.5</ProbTable></Entry>\n",
            "0.5 x</ProbTable></Entry>\n",
            "line 19: <ProbTable>: found 'x'; expected finite",
        ),
        (
            "0.5 0.5</ProbTable></Entry>\n",
            "0.7 0.7</ProbTable></Entry>\n",
            "line 19: transition of door.next at act=open, door=left: found probabilities that sum to 1.4; expected",
        ),
        (
            "open * -",
            "listen * -",
            "transition of door.next at act=open, door=left: found no distribution; expected sum 1",
        ),
        ('type="TBL"', 'type="CONT"', "line 17: transition of door.next: found type='CONT'; expected 'TBL' or 'DD'"),
        (
            '<Node var="door_1">',
            '<Node var="door_0">',
            "line 25: <Node>: found var='door_0'; expected a variable of the",
        ),
        (
            '<Edge val="left">',
            '<Edge val="lift">',
            "line 26: <Edge>: found val='lift'; expected a value of door.next (did",
        ),
        (
            'type="deterministic"',
            'type="certain"',
            "line 26: <SubDAG>: found type='certain'; expected uniform, determin",
        ),
        (
            'idref="other"',
            'idref="othre"',
            "line 27: <SubDAG>: found idref='othre'; expected a template's id (did you mean",
        ),
        ('type="uniform" var="sound"', 'type="persistent" var="sound"', "line 29: <SubDAG>: found persistent sound"),
        ('type="uniform" var="sound"', 'type="uniform" var="door_1"', "found door_1 a second time on one path"),
        (
            "<Var>cost</Var>",
            "<Var>costs</Var>",
            "line 31: <Var>: found 'costs'; expected the name of a <RewardVar> (did",
        ),
        (
            "<Parent>act</Parent>",
            "<Parent>cost</Parent>",
            "line 33: <Parent>: found 'cost'; expected a variable that may",
        ),
        (
            "-1</ValueTable>",
            "</ValueTable>",
            "line 34: <ValueTable>: found 0 numbers; expected 1, as the instance holds",
        ),
        ('<RewardVar vname="cost"/>', '<RewardVar vname="cost"/><RewardVar vname="b"/>', "reward b: found no function"),
        ("<Parent>door_1</Parent>", "<Parent>door_1 sound</Parent>", "a variable that is its own parent"),
        ("</pomdpx>", "", "found no well-formed XML (no element found"),
        ("pomdpx", "pomdp", "line 1: file: found <pomdp> as the outermost element; expected <pomdpx>"),
    ],
)
def test_one_fault(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    found = faults(tmp_path, GOOD.replace(old, new))
    assert any(fault.startswith(expected) or expected in fault for fault in found), found


@pytest.mark.example
def test_all_faults_at_once_in_order(tmp_path: Path) -> None:
    text = GOOD.replace("identity", "identical").replace(
        "0.5 0.5</ProbTable></Entry></Par", "0.5 0.6</ProbTable></Entry></Par"
    )
    text = text.replace('val="left"', 'val="lift"').replace("-1</", "one</")
    assert [fault.split(":")[0] for fault in faults(tmp_path, text)] == ["line 12", "line 18", "line 26", "line 34"]


@pytest.mark.example
def test_a_fault_in_the_head_hides_nothing(tmp_path: Path) -> None:
    text = GOOD.replace("0.95", "2").replace("0.5 0.5</ProbTable></Entry></Par", "0.5 0.6</ProbTable></Entry></Par")
    text = text.replace("0.5 0.5</ProbTable></Entry>\n", "abc</ProbTable></Entry>\n").replace(
        'idref="other"', 'idref="o"'
    )
    text = text.replace(
        '<SubDAG type="deterministic" var="sound" val="l"/>',
        '<Node var="sound"><Edge val="l"><Terminal>0.5</Terminal></Edge>'
        '<Edge val="r"><Terminal>0.7</Terminal></Edge></Node>',
    )
    text = text.replace("<ValueTable>-1<", "<ValueTable>-1 2<")
    assert [fault.split("; ")[0] for fault in faults(tmp_path, text)] == [
        "line 2: <Discount>: found '2'",
        "line 12: initial belief of door: found probabilities that sum to 1.1",
        "line 19: <ProbTable>: found 'abc'",
        "line 26: observation of sound at door.next=left: found probabilities that sum to 1.2",
        "line 27: <SubDAG>: found idref='o'",
        "line 34: <ValueTable>: found 2 numbers",
    ]


@pytest.mark.example
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("vnameCurr", "vnameNext"),
        ("left right", "left left"),
        ("<ValueEnum>l r</ValueEnum>", "<NumValues>many</NumValues>"),
        ("<ValueEnum>l r</ValueEnum>", "<ValueEmun>l r</ValueEmun>"),
        ("RewardVar", "RewardVra"),
        ("<Discount>0.95</Discount>", "<Discuont>0.95</Discuont>"),
        ("<Var>door_1", "<Var>dor_1"),
        ("<Parent>act door_0</Parent>", "<Parnet>act door_0</Parnet>"),
        ("open * -", "opne * -"),
        ("<Instance>open * -</Instance>", "<Instnace>open * -</Instnace>"),
        ('<Edge val="left">', '<Edge val="lift">'),
        ('<Node var="door_1">', '<Node var="door_0">'),
        ('idref="other"', 'idref="othre"'),
        ("<Var>cost</Var>", "<Var>costs</Var>"),
    ],
)
def test_a_fault_has_no_faults_as_its_consequence(tmp_path: Path, old: str, new: str) -> None:
    text = GOOD.replace(old, new).replace("</RewardVra>", "")
    assert len(faults(tmp_path, text)) == 1


@pytest.mark.example
def test_a_missing_function_is_named(tmp_path: Path) -> None:
    begin, end = GOOD.index("<ObsFunction>"), GOOD.index("</ObsFunction>") + len("</ObsFunction>")
    found = faults(tmp_path, GOOD[:begin] + GOOD[end:])
    assert found == ["observation of sound: found no distribution; expected one for every variable"]
