"""The section of docs/results.md on the paper's table through pictures, and its figure, from figures/pictures.csv."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, get_type_hints

import numpy as np
from results_words import fill, signed, table, unsigned

from surveillance_domain.experiments.estimates import Estimate, estimate
from surveillance_domain.model.coverage import best_joint_coverage
from surveillance_domain.model.optics import depth_m, horizontal_fov_deg
from surveillance_domain.model.views import Views, build_views
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, save_figure, styled
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["COUNTS", "HEADING", "PAPER", "RUNS", "SITE", "PictureRun", "draw_table", "kept_runs", "section"]

SITE, RUNS, FIGURE = "lego", "pictures.csv", "pictures.png"
HEADING = "## The paper's table, through pictures"
COUNTS = (1, 2, 3, 4, 5)
PAPER = (98.2, 96.6, 93.3, 91.5, 87.0)
"""PercentObs with 1 to 5 robots (tab:realexp)."""
NAMES = {
    "pictures": "**P, emulated cameras, pictures**",
    "pictures-in-view": "the same runs, without what is seen beyond the modelled views",
    "drawn": "P, emulated cameras, detections drawn",
    "simulated": "P, simulated, measured eyes",
    "simulated-perfect": "P, simulated, perfect eyes",
    "full-information": "full information, simulated, measured eyes",
    "full-information-perfect": "full information, simulated, perfect eyes",
    "clairvoyant-perfect": "clairvoyant, simulated, perfect eyes",
}
COSTS = {
    ("pictures-in-view", "drawn"): "pictures instead of drawn detections",
    ("drawn", "simulated"): "emulated cameras instead of simulated ones",
    ("simulated", "simulated-perfect"): "measured eyes instead of perfect ones",
    ("pictures-in-view", "simulated-perfect"): "all of it",
    ("pictures-in-view", "full-information"): "P through pictures, against full information with measured eyes",
    ("pictures", "pictures-in-view"): "what is seen beyond the views brings back",
    ("pictures", "simulated-perfect"): "all of it, with what is seen beyond",
}
_LABELS = {"pictures": "P, pictures, all that is seen", "pictures-in-view": "P, pictures, in the modelled views only"}
_SHOWN = 0.05
"""In percent; less is 0.0 in the table."""
_BLUE, _RED, _GREEN = CAMERA_COLOURS[:3]
_LINES = {
    "pictures": {"color": _BLUE, "marker": "o", "linewidth": 2.2},
    "pictures-in-view": {"color": _BLUE, "marker": "o", "markerfacecolor": "white", "linestyle": ":"},
    "simulated": {"color": _GREEN, "marker": "^", "linestyle": "--"},
    "simulated-perfect": {"color": _RED, "marker": "s", "linestyle": "--"},
    "full-information-perfect": {"color": "#6b6b6b", "linestyle": (0, (4, 3)), "linewidth": 0.9},
    "clairvoyant-perfect": {"color": "#6b6b6b", "linestyle": (0, (1.5, 2.5)), "linewidth": 0.9},
}


class PictureRun(NamedTuple):
    """One run: PercentObs, the share of target-steps in the cameras' view, the share in view and seen; all in percent.

    ``beyond`` is the share of target-steps, within PercentObs, at which the target is seen beyond the view that the
    model gives the camera; ``outside`` those of them at which its cell is in no camera's view, ``right``
    those at which the cell reported is the true one. ``legible`` is the share at which some camera's picture shows who
    it is, in view or not (where there are pictures). ``missed`` counts target-steps in view after one in view at which
    the target was not seen in view, ``then_seen`` those of them at which it is. ``lost`` counts cameras' steps without
    a view.
    """

    row: str
    targets: int
    run: int
    percent: float
    in_view: float
    read: float
    beyond: float
    outside: float
    right: float
    legible: float
    missed: int
    then_seen: int
    lost: int
    restarts: int
    steps: int


def kept_runs(path: Path) -> list[PictureRun]:
    """The runs of a file; none where it is not there."""
    if not path.exists():
        return []
    kinds = get_type_hints(PictureRun)
    with path.open(newline="", encoding="utf-8") as file:
        return [PictureRun(**{name: read(row[name]) for name, read in kinds.items()}) for row in csv.DictReader(file)]


def section(figures: Path) -> str | None:
    """The section, its figure drawn anew; ``None`` where nothing was run."""
    runs = kept_runs(figures / RUNS)
    if not runs:
        return None
    runs += [
        one._replace(row="pictures-in-view", percent=one.percent - one.beyond) for one in runs if one.row == "pictures"
    ]
    site = load_site(SITE)
    save_figure(draw_table(runs), figures / FIGURE)
    parts = [HEADING, _opening(runs), f"![PercentObs through pictures](figures/{FIGURE})", _table(runs), _beyond(runs)]
    parts += [_layout(site, build_views(site)), _ceiling(runs), _costs(runs), _made_of(runs, site)]
    return "\n\n".join(parts) + "\n"


def _of(runs: Sequence[PictureRun], row: str, count: int) -> dict[int, PictureRun]:
    return {one.run: one for one in runs if (one.row, one.targets) == (row, count)}


def _percent(runs: Sequence[PictureRun], row: str, count: int) -> Estimate:
    return estimate(one.percent for _, one in sorted(_of(runs, row, count).items()))


def _lead(runs: Sequence[PictureRun], row: str, other: str, count: int) -> Estimate:
    ours, theirs = _of(runs, row, count), _of(runs, other, count)
    return estimate(ours[run].percent - theirs[run].percent for run in sorted(ours.keys() & theirs.keys()))


def _by_count(head: str, rows: Iterable[tuple[str, Iterable[str]]]) -> str:
    """A table with a column for each number of robots."""
    return table([head, *(f"m = {count}" for count in COUNTS)], [[name, *cells] for name, cells in rows], 1)


def _opening(runs: Sequence[PictureRun]) -> str:
    numbers = sorted({len(_of(runs, "pictures", count)) for count in COUNTS})
    told = f"{numbers[0]}" if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"
    lost = sum(one.lost for one in runs)
    views = "no camera lost a view in any of them" if not lost else f"cameras lost {lost} views in all of them together"
    return fill(
        f"""The paper's experiment with real cameras (tab:realexp), on emulated ones: three cameras with three presets
        each watch one to five robots on 10 × 8 cells. Made by `python benchmarks/results_pictures.py`: {told} runs of
        {runs[0].steps} steps a column; {views}. Cameras speak real HTTP on a virtual clock, pictures are JPEGs of a
        rendered floor with sensor noise, robots are found by their ArUco markers and move in metres (*continuous*
        truth). Run r is `surveillance run {SITE} --emulated --fast --targets m --steps {runs[0].steps} --seed r`, and
        gives the same number there. Every row watches the same motion, run by run. Intervals are Student's 95 %
        intervals over runs; every run stands in [{RUNS}](figures/{RUNS})."""
    )


def _table(runs: Sequence[PictureRun]) -> str:
    rows: list[tuple[str, Sequence[str]]] = [
        ("the paper (its own layout, real cameras)", [f"{one:.1f}" for one in PAPER])
    ]
    rows += [(name, [unsigned(_percent(runs, row, count)) for count in COUNTS]) for row, name in NAMES.items()]
    return _by_count("PercentObs", rows)


def _layout(site: Site, views: Views) -> str:
    """Where cameras stand and look, and how much of the floor that is."""
    best, how = best_joint_coverage(views)
    joint = float(np.mean(views.seen(best) > 0))
    union = float(np.mean(np.any([np.any(one > 0, axis=0) for one in views.detection], axis=0)))
    grid = site.grid
    heads = ["camera", "stands at (m)", "looks to", "presets: pan, tilt", "opening", "depth (m)", "cells in view"]
    rows = []
    for number, camera in enumerate(site.cameras):
        x, y, height = camera.mount.position_m
        angles = "; ".join(f"{one.name} {one.pan:g}°, {one.tilt:g}°" for one in camera.presets)
        opening = horizontal_fov_deg(camera.zoom_hfov, camera.presets[0].zoom)
        cells = ", ".join(str(int((one > 0).sum())) for one in views.detection[number])
        place = [camera.name, f"{x:g}, {y:g}, {height:g} up", f"{camera.mount.yaw_deg:g}°", angles]
        rows.append([*place, f"{opening:g}°", f"{depth_m(camera, camera.presets[0]):.2f}", cells])
    chosen = ", ".join(f"{c.name} {c.presets[p].name}" for c, p in zip(site.cameras, best, strict=True))
    probability, noise = site.cameras[0].detection_probability, site.cameras[0].cell_noise_m
    motion = site.targets
    said = f"""The layout is ours, for the paper prints none: cells of {grid.cell_m:g} m, steps of
    {site.control.step_s:g} s, robots that drive {motion.speeds_mps[0]:g} m/s, directions with σ =
    {motion.sigma_direction_deg:g}°. It was fixed before anything was run on it, and not changed since.
    **{how.capitalize()} joint preset ({chosen}) has
    {joint:.0%} of the floor in view; {union:.0%} is in view of some preset.** *Measured eyes*: detection probability
    {probability:g} and cell noise {noise:g} m, as `python -m benchmarks.run --only detection` finds them on emulated
    pictures of robots that stand at random; *perfect*: 1 and 0."""
    return f"{fill(said)}\n\n{table(heads, rows, len(heads))}"


def _ceiling(runs: Sequence[PictureRun]) -> str:
    """Whether the paper's numbers can be had on this layout at all."""
    tops = [_percent(runs, "clairvoyant-perfect", count) for count in COUNTS]
    short = [str(count) for count, paper, top in zip(COUNTS, PAPER, tops, strict=True) if paper > top.high]
    counting = "Counting what these fields of view hold, no controller can reach the paper's figures"
    if len(short) == len(COUNTS):
        head = f"**{counting}, with any number of robots.**"
    elif short:
        head = f"**{counting} for m = {', '.join(short)}.**"
    else:
        head = "The paper's figures lie within what this layout allows."
    ladder = ("clairvoyant-perfect", "simulated-perfect", "pictures-in-view", "pictures")
    means = [np.array([_percent(runs, row, count).mean for count in COUNTS]) for row in ladder]
    gaps = [above - below for above, below in zip([np.array(PAPER), *means], means[:3], strict=False)]
    whole, (beyond_reach, not_known, eyes) = np.array(PAPER) - means[2], gaps
    return fill(
        f"""{head} The clairvoyant knows where every robot will be and has perfect eyes: it observes
        {tops[0].mean:.1f} % with one robot and {tops[-1].mean:.1f} % with five. Of the {_span(whole)} points between
        the paper and what P sees in view through pictures, {_span(beyond_reach)} lie above the clairvoyant: no choice
        of presets can gain them where these cameras stand, see so far, and these robots drive. {_span(not_known)} lie
        between the clairvoyant and P with perfect eyes, and
        {_span(eyes)} are what eyes and pictures cost. Sightings beyond the views bring {_span(means[3] - means[2])}
        points back, so that {_span(np.array(PAPER) - means[3])} are left. The paper prints neither the size of its
        cells nor where its cameras stood; to enlarge fields of view until the numbers meet would prove nothing, so it
        was not done."""
    )


def _span(values: Iterable[float]) -> str:
    low, *_, high = (f"{value:.1f}" for value in sorted(values))
    return low if low == high else f"{low} to {high}"


def _costs(runs: Sequence[PictureRun]) -> str:
    rows = [
        (name, [signed(_lead(runs, row, other, count)) for count in COUNTS]) for (row, other), name in COSTS.items()
    ]
    told = (
        "What pictures cost, in points, paired run by run; what is seen beyond the views counts in the last two rows:"
    )
    return f"{told}\n\n{_by_count('', rows)}"


def _made_of(runs: Sequence[PictureRun], site: Site) -> str:
    """PercentObs as in view times seen; what pictures show beyond; whether misses come in rows."""
    rows, seen, after = [], {}, {}
    for row in ("pictures", "drawn", "simulated", "simulated-perfect"):
        of = [list(_of(runs, row, count).values()) for count in COUNTS]
        name = NAMES[row].strip("*")
        rows.append((f"{name}: in view", [f"{np.mean([one.in_view for one in some]):.1f}" for some in of]))
        seen[row] = [_share([one.read for one in some], [one.in_view for one in some]) for some in of]
        rows.append((f"{name}: seen, of those in view", [f"{value:.1f}" for value in seen[row]]))
        flat = [one for some in of for one in some]
        after[row] = _share([one.then_seen for one in flat], [one.missed for one in flat])
    for key, name in (("legible", "read in some picture, in view or not"), ("beyond", "seen beyond the view")):
        rows.insert(2, (f"the same: {name}", [f"{value:.1f}" for value in _means(runs, key)]))
    said = f"""*In view*: share of target-steps at which the robot's cell is in the view of a camera, as the model has
    it; *seen*: of those, at which a camera that has it in view reports it. A cell may be in view of two cameras, so
    even of drawn detections more than {site.cameras[0].detection_probability:.0%} of what is in view is seen:
    {_span(seen["drawn"])} %. Through pictures it is {_span(seen["pictures"])} %. The model draws misses anew at each
    look and for each camera; real ones need not be like that: of the robots in view one step after they were missed in
    view, pictures show {after["pictures"]:.0f} % in view, drawn detections {after["drawn"]:.0f} %."""
    return f"What PercentObs is made of, in percent:\n\n{_by_count('', rows)}\n\n{fill(said)}"


def _beyond(runs: Sequence[PictureRun]) -> str:
    """What is seen beyond the views, and why the first row is not to be held against the bounds."""
    of = [one for one in runs if one.row == "pictures"]
    elsewhere = 100 - _share([one.outside for one in of], [one.beyond for one in of])
    right = _share([one.right for one in of], [one.beyond for one in of])
    unused = np.array(_means(runs, "legible")) - [_percent(runs, "pictures", count).mean for count in COUNTS]
    more = f"{_span(unused)} % of target-steps" if unused.max() >= _SHOWN else "no other target-step"
    return fill(
        f"""**The first row of ours counts more than the others can.** To the model a view ends where a cell's middle
        leaves the picture, and at the depth that the site file gives; pictures show markers beyond both. A robot that
        is seen there is seen: it counts, and the belief goes by it, though the choice of presets does not reckon with
        it. At {_span(_means(runs, "beyond"))} % of target-steps that is all that is seen of a robot; in
        {elsewhere:.0f} % of these its cell is in some camera's view all the same, and {right:.1f} % are put into the
        right cell. At {more} is a marker read that is not used. Drawn detections, simulated rows and bounds know of the
        model's views alone, so the first row may lie above them for that reason; the second row, which leaves these
        sightings out of the count, is the one to compare."""
    )


def _means(runs: Sequence[PictureRun], share: str) -> list[float]:
    """Means of one share over runs through pictures, by number of robots."""
    return [float(np.mean([getattr(one, share) for one in _of(runs, "pictures", count).values()])) for count in COUNTS]


def _share(parts: Sequence[float], wholes: Sequence[float]) -> float:
    """In percent, over all runs together; nan of nothing."""
    whole = float(np.sum(wholes))
    return 100 * float(np.sum(parts)) / whole if whole else float("nan")


@styled
def draw_table(runs: Sequence[PictureRun]) -> Figure:
    """The paper's row, and ours with their intervals; small dots are runs through pictures."""
    figure = new_figure(7.2, 3.9)
    axes = figure.subplots()
    axes.plot(COUNTS, PAPER, "D-", color=INK, linewidth=1.4, label="the paper: real cameras, its own layout")
    for row, look in _LINES.items():
        found = [_percent(runs, row, count) for count in COUNTS]
        means, halves = [one.mean for one in found], [one.half_width for one in found]
        if "marker" in look and np.isfinite(halves).all():
            axes.errorbar(COUNTS, means, halves, fmt="none", ecolor=look["color"], elinewidth=1.0, capsize=2.5)
        axes.plot(COUNTS, means, label=_LABELS.get(row, NAMES[row]), **look)
    for count in COUNTS:
        dots = _percent(runs, "pictures", count).samples
        axes.plot([count + 0.06] * len(dots), dots, ".", color=_BLUE, markersize=2.5, alpha=0.4)
    axes.set(xlabel="number m of robots", ylabel="PercentObs (%)", xticks=COUNTS, ylim=(None, 101))
    axes.grid(axis="y", color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    number = len(_of(runs, "pictures", COUNTS[0]))
    figure.suptitle(f"{SITE}: {number} runs of {runs[0].steps} steps a number of robots; bars: 95 % confidence")
    return figure
