"""Make the paper's table (tab:realexp) on emulated cameras with pictures in the loop: its section of docs/results.md.

``python benchmarks/results_pictures.py`` runs the site `lego` with 1 to 5 robots through pictures: real HTTP, JPEG and
marker detection on a virtual clock. Run r is what ``surveillance run lego --emulated --fast --seed r`` does. On the
same motion it runs P with drawn detections and in the simulated world, and the bounds. All runs stand in
docs/figures/pictures.csv, which is written after each and gone on from; the section is made from that file alone.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from results_pictures_text import COUNTS, HEADING, RUNS, SITE, PictureRun, kept_runs, section
from results_table import write_text

if TYPE_CHECKING:
    from surveillance_domain.commands.network import Network
    from surveillance_domain.control.base import Controller
    from surveillance_domain.control.loop import Step
    from surveillance_domain.model.build import Surveillance
    from surveillance_domain.world.base import World
    from surveillance_domain.world.truth import Truth

__all__ = ["main", "section"]

STEPS = 100
DOCS = Path(__file__).parents[1] / "docs"
_START_S = 10.0
_SIMULATED = (
    ("simulated", "pomdp", False),
    ("simulated-perfect", "pomdp", True),
    ("full-information", "full-information", False),
    ("full-information-perfect", "full-information", True),
    ("clairvoyant-perfect", "clairvoyant", True),
)
"""Rows without cameras: name, controller, and whether its eyes are perfect."""


def main() -> None:
    """Run what is missing, and write the section."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=10, help="of each number of robots")
    parser.add_argument("--out", type=Path, default=DOCS, help="folder for results.md and figures/")
    parser.add_argument("--text-only", action="store_true", help="write the section again from figures/pictures.csv")
    given = parser.parse_args()
    figures = given.out / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    if not given.text_only:
        _make(figures / RUNS, given.runs)
    text = section(figures)
    if text:
        page = given.out / "results.md"
        written = page.read_text(encoding="utf-8") if page.exists() else "# Results\n"
        write_text(page, _replaced(written, text))
        print(f"Written: the section in {page}", file=sys.stderr)


def _replaced(page: str, text: str) -> str:
    """The page with its section of that heading made anew, or with it at its end."""
    before, heading, after = page.partition(f"\n{HEADING}\n")
    rest = after.partition("\n## ")
    tail = f"\n## {rest[2]}" if heading and rest[1] else ""
    return f"{before.rstrip()}\n\n{text}{tail}"


def _make(path: Path, runs: int) -> None:
    """Add the runs that are not there, numbers of robots in turn, so that what stands is even when it is broken off."""
    from surveillance_domain.commands.progress import progress_bar

    rows = kept_runs(path)
    there = {(row.targets, row.run) for row in rows}
    missing = [(count, run) for run in range(runs) for count in COUNTS if (count, run) not in there]
    with progress_bar("running", len(missing), True) as advance:
        for count, run in missing:
            rows += _one(count, run)
            rows.sort(key=lambda row: (row.targets, row.run))
            _write(path, rows)
            advance(1)


def _one(count: int, run: int) -> Iterator[PictureRun]:
    """One motion of the robots, watched in every way."""
    with _emulated(count, run, pictures=True) as network:
        start = network.truth()
        yield _watched("pictures", network, run)
    with _emulated(count, run, pictures=False) as network:
        yield _watched("drawn", network, run)
    for name, controller, perfect in _SIMULATED:
        yield _simulated(name, controller, _model(count, perfect), start, run)


@contextmanager
def _emulated(count: int, run: int, pictures: bool) -> Iterator[Network]:
    from surveillance_domain.commands.network import network_of
    from surveillance_domain.site.load import load_site

    site = load_site(SITE)
    with network_of(site, count, emulated=True, seed=run, virtual=True, pictures=pictures) as network:
        faults = network.world.start(_START_S)
        if faults:
            raise SystemExit("; ".join(map(str, faults.values())))
        yield network


def _model(count: int, perfect: bool) -> Surveillance:
    from surveillance_domain.experiments.setup import Setup, surveillance_of

    return surveillance_of(Setup(SITE, count, 1.0, 0.0) if perfect else Setup(SITE, count))


def _watched(name: str, network: Network, run: int) -> PictureRun:
    """P on emulated cameras, as ``surveillance run`` has it."""
    from surveillance_domain.control.factory import Setting, make_controller

    controller = make_controller("pomdp", network.surveillance, Setting(open_roster=True))
    return _followed(name, network.world, controller, network.surveillance, network.truth, run, _legible(network))


def _legible(network: Network) -> Callable[[], np.ndarray] | None:
    """Whose marker some camera's last picture shows; ``None`` without pictures."""
    from surveillance_domain.model.looks import looks
    from surveillance_domain.world.picture_eyes import PictureEyes

    eyes = network.eyes
    if not isinstance(eyes, PictureEyes):
        return None
    markers = [look.marker for look in looks(network.surveillance.site, len(network.surveillance.targets))]

    def found() -> np.ndarray:
        read = {one.detection.identity for sight in eyes.sights.values() for one in sight.located}
        return np.array([marker in read for marker in markers])

    return found


def _simulated(name: str, controller: str, surveillance: Surveillance, start: Truth, run: int) -> PictureRun:
    """The same motion in the simulated world."""
    from surveillance_domain.control.factory import Setting, make_controller
    from surveillance_domain.world.simulated import SimulatedWorld

    world = SimulatedWorld(surveillance, start, np.random.default_rng([run, len(surveillance.targets)]))
    chosen = make_controller(controller, surveillance, Setting(world, STEPS, run))
    return _followed(name, world, chosen, surveillance, lambda: world.truth, run)


def _followed(
    name: str,
    world: World,
    controller: Controller,
    surveillance: Surveillance,
    truth: Callable[[], Truth],
    run: int,
    legible: Callable[[], np.ndarray] | None = None,
) -> PictureRun:
    """PercentObs of a run, and what it is made of."""
    from surveillance_domain.control.loop import turns

    count = len(surveillance.targets)
    seen = in_view = read = beyond = outside = right = shown = missed = then_seen = lost = 0
    missing = np.zeros(count, dtype=bool)
    for step in islice(turns(world, controller), STEPS):
        cells = truth().cells
        covered, told = _covered(surveillance, step)[cells], _told(surveillance, step)
        past = np.array([target in step.sighting.beyond for target in surveillance.targets])
        found, own = told >= 0, (told >= 0) & ~past
        seen, in_view, read = seen + found.sum(), in_view + covered.sum(), read + (own & covered).sum()
        beyond, outside = beyond + past.sum(), outside + (past & ~covered).sum()
        right += (past & (told == cells)).sum()
        shown += (found if legible is None else found | legible()).sum()
        again = missing & covered
        missed, then_seen, missing = missed + again.sum(), then_seen + (again & own).sum(), covered & ~own
        lost += sum(view is None for view in step.sighting.views.values())
    share = 100 / (STEPS * count)
    shares = [share * one for one in (seen, in_view, read, beyond, outside, right, shown)]
    return PictureRun(name, count, run, *shares, int(missed), int(then_seen), lost, controller.restarts, STEPS)


def _told(surveillance: Surveillance, step: Step) -> np.ndarray:
    """Number of the cell at which each target was seen; -1: it was not."""
    number = surveillance.site.grid.number
    cells = [step.sighting.observations[target] for target in surveillance.targets]
    return np.array([-1 if cell is None else number[cell[1], cell[0]] for cell in cells])


def _covered(surveillance: Surveillance, step: Step) -> np.ndarray:
    """Cells in the view that the cameras really had."""
    views = [step.sighting.views[camera.name] for camera in surveillance.site.cameras]
    names = [[preset.name for preset in camera.presets] for camera in surveillance.site.cameras]
    numbers = [None if view is None else own.index(view) for view, own in zip(views, names, strict=True)]
    covered: np.ndarray = surveillance.views.seen(numbers) > 0
    return covered


def _write(path: Path, rows: list[PictureRun]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(PictureRun._fields)
    writer.writerows([f"{value:.6g}" if isinstance(value, float) else value for value in row] for row in rows)
    write_text(path, text.getvalue())


if __name__ == "__main__":
    main()
