"""Alpha vectors of a problem with two states, drawn; the numbers behind the lines."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.commands import main
from factored_pomdp.pictures.vectors import draw_vectors
from solvers.exact import Exact
from solvers.point_based import PointBased
from solvers.solution import Limits, Solution


def one_step() -> Solution:
    return Exact(fp.domain("tiger")).solve(Limits(horizon=1))


@pytest.mark.example
def test_tiger_for_one_step_by_hand() -> None:
    shown = one_step().two_states()
    assert shown.axis == "tiger = right"
    by_action = {shown.names[action]: tuple(row) for action, row in zip(shown.actions, shown.vectors, strict=True)}
    assert by_action == {"listen": (-1.0, -1.0), "open-left": (-100.0, 10.0), "open-right": (10.0, -100.0)}
    # Listening is worth as much as opening the left door where 110 p - 100 = -1, at p = 0.9.
    at = np.searchsorted(shown.probabilities, [0.0, 0.5, 0.95])
    assert shown.lower[at] == pytest.approx([10.0, -1.0, 4.5])
    assert shown.upper == pytest.approx(shown.lower)


@pytest.mark.example
def test_what_is_drawn() -> None:
    (axes,) = draw_vectors(one_step().two_states(), "tiger").get_axes()
    assert axes.get_xlabel() == "probability of tiger = right"
    thin = [line for line in axes.lines if line.get_linewidth() < 1]
    assert {(line.get_ydata()[0], line.get_ydata()[-1]) for line in thin} == {(-1, -1), (-100, 10), (10, -100)}
    assert len({line.get_color() for line in thin}) == 3
    strip = [(patch.get_x(), patch.get_width()) for patch in axes.patches]
    assert [start for start, _ in strip] == pytest.approx([0.0, 0.1, 0.9], abs=2e-3)
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["listen", "open-left", "open-right"]


@pytest.mark.example
def test_a_gap_shows_the_upper_bound() -> None:
    shown = PointBased(fp.domain("tiger")).solve(Limits(precision=3.0)).two_states()
    assert (shown.upper >= shown.lower - 1e-9).all()
    assert (np.diff(shown.upper, 2) >= -1e-9).all()  # convex
    middle = len(shown.probabilities) // 2
    assert shown.lower[middle] <= 19.371368 <= shown.upper[middle]
    (axes,) = draw_vectors(shown, "tiger").get_axes()
    assert "upper bound" in {text.get_text() for text in axes.figure.legends[0].get_texts()}
    # At the ends the upper bound is that of a known state: far beyond what the picture is about.
    assert axes.get_ylim()[1] < shown.upper.max()


@pytest.mark.example
def test_more_than_two_states_are_refused_with_the_number() -> None:
    solved = Exact(fp.domain("machine-repair", machines=1)).solve(Limits(horizon=1))
    with pytest.raises(ValueError, match="machine-repair has 3 states; expected two"):
        solved.two_states()


@pytest.mark.example
def test_two_states_that_are_seen_are_refused() -> None:
    lamp, act = fp.Variable("lamp", ["on", "off"]), fp.Variable("act", ["wait"])
    model = fp.FactoredPOMDP(
        states=[lamp],
        actions=[act],
        observations=[fp.Variable("seen", ["on", "off"])],
        transition={"lamp": lambda lamp: {"on": 0.5, "off": 0.5}},
        observation={"seen": lambda lamp_next: lamp_next},
        reward={"light": fp.table("lamp", values={"on": 1.0, "off": 0.0})},
        initial={"lamp": "on"},
        discount=0.5,
    )
    with pytest.raises(ValueError, match="2 states that can be told apart"):
        Exact(model).solve(Limits(horizon=1)).two_states()


@pytest.mark.end_to_end
def test_solve_draws_and_refuses(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    def run(*arguments: str) -> tuple[int, dict]:
        with pytest.raises(SystemExit) as ended:
            main(["solve", *arguments, "--json"])
        return int(ended.value.code or 0), json.loads(capsys.readouterr().out)

    out = tmp_path / "tiger.svg"
    code, answer = run("tiger", "--precision", "1", "--picture", str(out))
    assert code == 0
    assert answer["picture"] == [str(out.with_suffix(".png")), str(out)]
    assert out.read_text(encoding="utf-8").startswith("<?xml")
    code, answer = run("machine-repair", "--picture", str(tmp_path / "repair.png"))
    assert (code, "has 27 states; expected two" in answer["error"]) == (2, True)
    code, answer = run("tiger", "--picture", str(tmp_path / "tiger.pdf"))
    assert (code, "ends with .png or .svg" in answer["error"]) == (2, True)
    assert {path.name for path in tmp_path.iterdir()} == {"tiger.png", "tiger.svg"}
