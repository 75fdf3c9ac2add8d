"""The paper's table through pictures: runs that are gone on from, and the words that the numbers make."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

pytest.importorskip("cv2")

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def measure(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import results_pictures

    return results_pictures


@pytest.mark.end_to_end
@pytest.mark.slow
def test_runs_are_those_of_the_command_and_are_not_made_twice(
    measure: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import results_pictures_text

    from surveillance_domain.commands.network import network_of
    from surveillance_domain.control.factory import Setting, make_controller
    from surveillance_domain.control.watch import Watch
    from surveillance_domain.site.load import load_site

    monkeypatch.setattr(measure, "STEPS", 4)
    monkeypatch.setattr(measure, "COUNTS", (2,))
    path = tmp_path / "pictures.csv"
    measure._make(path, 1)
    first = results_pictures_text.kept_runs(path)
    assert [row.row for row in first] == [row for row in results_pictures_text.NAMES if row != "pictures-in-view"]
    assert {(row.targets, row.run, row.steps, row.lost) for row in first} == {(2, 0, 4, 0)}
    with network_of(load_site("lego"), 2, emulated=True, seed=0, virtual=True) as network:
        network.world.start(10.0)
        controller = make_controller("pomdp", network.surveillance, Setting(open_roster=True))
        watch = Watch(network.world, controller, truth=network.truth)
        for step in watch.turns():
            if step.number == 4:
                break
        assert watch.summary()["percent_obs"] == pytest.approx(first[0].percent)
    made: list[tuple[int, int]] = []

    def one(count: int, run: int) -> Iterator[Any]:
        made.append((count, run))
        yield first[0]._replace(run=run)

    monkeypatch.setattr(measure, "_one", one)
    measure._make(path, 3)
    assert made == [(2, 1), (2, 2)]
    assert results_pictures_text.kept_runs(path)[: len(first)] == first


@pytest.mark.example
def test_the_section_says_what_the_runs_say(measure: ModuleType, tmp_path: Path) -> None:
    assert measure.section(tmp_path) is None
    percent = {
        "pictures": 70.0,
        "drawn": 64.0,
        "simulated": 65.0,
        "simulated-perfect": 72.0,
        "full-information": 67.0,
        "full-information-perfect": 75.0,
        "clairvoyant-perfect": 85.0,
    }
    eyes = {"pictures": (80.0, 60.0, 10.0, 8.0, 9.0)}
    others = (80.0, 60.0, 0.0, 0.0, 0.0)
    rows = [
        measure.PictureRun(row, count, run, value + run - count, *eyes.get(row, others), 90.0, 10, 4, 0, 0, 100)
        for row, value in percent.items()
        for count in measure.COUNTS
        for run in range(2)
    ]
    with (tmp_path / measure.RUNS).open("w", newline="") as file:
        csv.writer(file).writerows([measure.PictureRun._fields, *rows])
    text = " ".join(measure.section(tmp_path).split())
    assert text.startswith("## The paper's table, through pictures")
    assert "2 runs of 100 steps a column; no camera lost a view" in text
    assert "| the paper (its own layout, real cameras) | 98.2 | 96.6 | 93.3 | 91.5 | 87.0 |" in text
    # 69 and 70 with one robot: mean 69.5 ± 12.706 · 0.5; ten of them seen beyond the views.
    assert "| **P, emulated cameras, pictures** | 69.5 ± 6.4 |" in text
    assert "| the same runs, without what is seen beyond the modelled views | 59.5 ± 6.4 |" in text
    assert "| what is seen beyond the views brings back | +10.0 ± 0.0 |" in text
    assert "| pictures instead of drawn detections | -4.0 ± 0.0 |" in text
    assert "| P, emulated cameras, pictures: seen, of those in view | 75.0 |" in text
    assert (
        "| south | 1.5, -0.3, 1.2 up | 90° | left -40°, -40°; middle 0°, -40°; right 40°, -40° | 48° | 2.40 |" in text
    )
    assert "| the same: read in some picture, in view or not | 90.0 |" in text
    assert "| the same: seen beyond the view | 10.0 |" in text
    assert "At 10.0 % of target-steps that is all that is seen of a robot" in text
    assert "in 20 % of these its cell is in some camera's view all the same, and 90.0 % are put into the right" in text
    # Means are 69.5 to 65.5.
    assert "At 20.5 to 24.5 % of target-steps is a marker read that is not used" in text
    assert "pictures show 40 % in view, drawn detections 40 %" in text
    # The clairvoyant: 84.5, 83.5, 82.5, 81.5, 80.5, each ± 6.4; the paper is 13.7, 13.1, 10.8, 10.0, 6.5 above it.
    assert "no controller can reach the paper's figures, with any number of robots" in text
    assert "6.5 to 13.7 lie above the clairvoyant" in text
    assert "13.0 lie between the clairvoyant and P with perfect eyes, and 12.0 are what eyes and pictures cost" in text
    assert "bring 10.0 points back, so that 21.5 to 28.7 are left" in text
    assert (tmp_path / "pictures.png").stat().st_size > 10_000
    assert (tmp_path / "pictures.svg").exists()


@pytest.mark.example
def test_the_section_takes_the_place_of_the_one_that_was_there(measure: ModuleType) -> None:
    page = f"# Results\n\nwords\n\n{measure.HEADING}\n\nold\n\n## Another\n\nmore\n"
    assert measure._replaced(page, f"{measure.HEADING}\n\nnew\n") == page.replace("old", "new")
    end = page.partition("\n## Another")[0]
    assert measure._replaced(end, f"{measure.HEADING}\n\nnew\n") == f"# Results\n\nwords\n\n{measure.HEADING}\n\nnew\n"
    assert measure._replaced("# Results\n", f"{measure.HEADING}\n\nnew\n") == f"# Results\n\n{measure.HEADING}\n\nnew\n"
