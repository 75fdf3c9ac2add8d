"""The benchmark of detection counts what it says it counts."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.detection import Tally, detection
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.observe import Cell, Located


def at(identity: int, point_m: tuple[float, float], cell: Cell) -> Located:
    return Located(Detection((0.0, 0.0), 0.1, "marker", identity, 1.0, 30.0), point_m, cell)


@pytest.mark.example
def test_a_tally_by_hand() -> None:
    # Cells of 0.3 m: the targets are in [0, 0], [1, 0] and [2, 0]; the third is not in view, the second is not found.
    places, counted = np.array([[0.1, 0.1], [0.4, 0.1], [0.7, 0.1]]), np.array([True, True, False])
    tally = Tally()
    tally.add(load_site("lego"), places, counted, [at(0, (0.1, 0.13), (0, 0)), at(2, (0.7, 0.1), (2, 0))])
    tally.add(load_site("lego"), places, counted, [at(0, (0.1, 0.06), (1, 0)), at(17, (0.4, 0.1), (1, 0))])
    found = tally.figures()
    assert (found["shown"], found["rate"], found["wrong_identities"], found["right_cell"]) == (4, 0.5, 1, 0.5)
    assert found["rms_m"] == pytest.approx(np.sqrt((0.03**2 + 0.04**2) / 2))
    assert found["worst_m"] == pytest.approx(0.04)
    # Wilson's interval for 2 of 4, by hand: (0.5 + z²/8 ± z sqrt(1/16 + z²/64)) / (1 + z²/4), z = 1.96
    assert found["ci95"] == pytest.approx([0.150, 0.850], abs=0.001)


@pytest.mark.end_to_end
def test_large_markers_are_found_and_tiny_ones_are_not() -> None:
    report = detection(quick=True, seed=0, pictures=60)
    by_size = sorted(report.figures["plain_view"], key=lambda one: one["side_px"])
    assert by_size[0]["side_px"] < 10 < 40 < by_size[-1]["side_px"]
    assert (by_size[0]["rate"], by_size[-1]["rate"]) == (0.0, 1.0)
    assert by_size[-1]["rms_m"] < 0.005
    assert [one.met for one in report.aims] == [True]
    assert {one["camera"] for one in report.figures["on_site"]} == {"south", "north-west", "north-east", "all cameras"}
    assert len(report.rows) == len(report.figures["plain_view"]) + len(report.figures["on_site"])
