"""The words of docs/results-people.md; every figure and every verdict in it is worked out from the windows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from results_people import FINE, FINE_DIRECTIONS, FITS, GUESSED, PEOPLE, STEPS, WATCHING, Scene
from results_table import read_rows
from results_words import VERDICTS, fill, made_by, signed, table, unsigned, words

from surveillance_domain.experiments.estimates import Estimate, estimate
from surveillance_domain.experiments.variants import ALL_NAMES, BOUNDS
from surveillance_domain.model.motion_direction import turning_deg
from surveillance_domain.site.load import load_site

FULL_WINDOWS = 19
"""Of the longest recording."""
NAMES = {**ALL_NAMES, GUESSED: "P, guessed motion", FINE: f"P, {FINE_DIRECTIONS} directions"}
_MOST_WINDOWS = 10
"""So many times more: what would take longer to decide counts as no difference."""
RIVALS = tuple(name for name in WATCHING if name not in ("pomdp", FINE))
_ABOUT = """Recorded people in the place of simulated targets: they do not follow the model, come and go as they please,
and nobody knows beforehand how they walk. For each scene the motion model was **learned on the other scene**, never on
itself; camera poses, doors and their rates were fixed from the map's or the picture's geometry before any controller
was run, and stand with their reasons in the site files. Everybody who is on the map at some time of a window is one
target; a target that is outside counts for nothing. Intervals are Student's 95 % over windows, those of differences
paired, window by window; windows of one recording follow one another, so they are not quite independent."""
_BOUNDS = """Full information knows where everybody is and in which direction bin they walk, and foretells one step by
the learned motion, which is not how they really walk: here it bounds nothing, strictly. The clairvoyant knows the
recording, and bounds everything."""
_MISSED = """What is missed, in shares of target-steps: *unmet*, people who have come in and whom nobody has seen in the
window so far; *lost*, people who were seen before. Of the unmet a belief knows no more than that they come in by a
door; a motion model helps with the lost. *Restarts*: sightings that P's belief called impossible, in a thousand
target-steps."""
_FORETOLD = """*Faster*: share of the moves in the scene that are faster than the fastest speed learned for it.
Then the log-likelihood of the cell of the next position, in nats a step, in the scene for which it was learned
(towards 0 is better): of the model, of the same on the grid with 8 directions as the belief has it, of a random walk
and of constant velocity (these two with widths from the scene of learning, too)."""
_COARSE = """The paper's directions are few, and the sites have as many. People who turn little turn still less in a
belief whose bins are far wider than their turns: it goes straight on until it jumps by a whole bin. More directions
cost memory and time in proportion."""
_CHECKED = """One controller against all windows of a scene is a matter of seconds; what stands in `per_run` are the
windows, and their mean is in the table. In the folder of the recordings, with the sites of `benchmarks/sites` copied
there:"""
_DATA = """Recordings: S. Pellegrini, A. Ess, K. Schindler, L. van Gool, *You'll never walk alone* (ICCV 2009), and
A. Lerner, Y. Chrysanthou, D. Lischinski, *Crowds by example* (Eurographics 2007). They are not part of this project,
and only aggregates over windows are published here: [people.csv](figures/people.csv) and
[people-fits.csv](figures/people-fits.csv)."""


@dataclass(frozen=True)
class People:
    """Windows by scene, controller and number, each under the names of `results_people.Watched`; and the fits."""

    windows: Mapping[tuple[str, str], Mapping[int, Mapping[str, float]]]
    fits: Sequence[Mapping[str, str]]
    seed: int

    def mean(self, scene: str, controller: str, what: str = "percent") -> Estimate:
        """Over windows."""
        return estimate(one[what] for one in self.windows[scene, controller].values())

    def lead(self, scene: str, other: str, name: str = "pomdp") -> Estimate:
        """P (or another that is ours) minus another, window by window."""
        ours, theirs = self.windows[scene, name], self.windows[scene, other]
        return estimate(ours[number]["percent"] - theirs[number]["percent"] for number in sorted(ours))

    def total(self, scene: str, controller: str, what: str) -> float:
        """Sum over windows."""
        return sum(one[what] for one in self.windows[scene, controller].values())

    def share(self, scene: str, controller: str, what: str) -> float:
        """A share of target-steps, over all windows together."""
        of = self.windows[scene, controller].values()
        return float(np.average([one[what] for one in of], weights=[one["present"] for one in of]))


def read_people(figures: Path) -> People:
    """What stands in ``people.csv`` and ``people-fits.csv``."""
    windows: dict[tuple[str, str], dict[int, dict[str, float]]] = {}
    for row in read_rows(figures / PEOPLE):
        numbers = {name: float(value) for name, value in row.items() if name not in ("scene", "controller")}
        windows.setdefault((row["scene"], row["controller"]), {})[int(row["window"])] = numbers
    return People(windows, read_rows(figures / FITS), int(row["seed"]))


def page(people: People, scenes: Sequence[Scene]) -> str:
    """The whole page."""
    return (
        "\n\n".join(
            [
                "# Recorded people",
                _opening(people, scenes),
                fill(_ABOUT),
                _rankings(people, scenes),
                "![PercentObs against recorded people](figures/people.png)",
                _means(people, scenes),
                fill(_BOUNDS),
                _missed(people, scenes),
                _exceptions(people, scenes),
                *_directions(people, scenes),
                _learned(people, scenes),
                _checked(scenes),
                fill(_DATA),
            ]
        )
        + "\n"
    )


def _opening(people: People, scenes: Sequence[Scene]) -> str:
    told = []
    for scene in scenes:
        count = len(people.windows[scene.name, "pomdp"])
        met = people.mean(scene.name, "pomdp", "people").mean
        told.append(f"{count} windows of {scene.title} ({met:.0f} people in a window)")
    longest = max(len(people.windows[scene.name, "pomdp"]) for scene in scenes)
    found = made_by(longest, FULL_WINDOWS, people.seed)
    return fill(f"{found}: {words(told)}, each of {STEPS} steps of a second, seed {people.seed}.")


def _checked(scenes: Sequence[Scene]) -> str:
    """How a reader makes a line of the table anew."""
    lines = []
    for scene in scenes:
        (other,) = (one for one in scenes if one.name != scene.name)
        site, (x, y) = scene.site.name, scene.placement.offset_m
        turned = f" --rotate-deg {scene.placement.rotate_deg:g}" if scene.placement.rotate_deg else ""
        lines += [
            f"surveillance learn {other.recording} --frames-per-s {other.frames_per_s:g} --step-s 1 --cell-m 1 "
            f"--write {site}",
            f"surveillance replay {site} {scene.recording} --frames-per-s {scene.frames_per_s:g} --steps {STEPS} "
            f"--offset-m={x:g},{y:g}{turned} --controller pomdp --json",
        ]
    return "\n".join(["## To see it again", "", fill(_CHECKED), "", "```sh", *lines, "```"])


def _rankings(people: People, scenes: Sequence[Scene]) -> str:
    """What does not hold comes first."""
    said: dict[int, list[str]] = {-1: [], 0: [], 1: []}
    for scene in scenes:
        for name in RIVALS:
            if name not in BOUNDS:
                lead = people.lead(scene.name, name)
                said[lead.verdict].append(f"{scene.name}: P above {NAMES[name]}, {signed(lead)}")
    lines = ["## Which rankings hold", ""]
    for verdict, found in said.items():
        lines += [f"- {VERDICTS[verdict]}: {one}" for one in found]
    return "\n".join(lines)


def _means(people: People, scenes: Sequence[Scene]) -> str:
    rows = []
    for name in WATCHING:
        cells = [NAMES[name]]
        for scene in scenes:
            cells.append(unsigned(people.mean(scene.name, name)))
            cells.append("" if name == "pomdp" else signed(people.lead(scene.name, name)))
        rows.append(cells)
    heads = [head for scene in scenes for head in (f"{scene.name}: PercentObs", "P minus it")]
    return table(["controller", *heads], rows, 1)


def _missed(people: People, scenes: Sequence[Scene]) -> str:
    rows = []
    for scene in scenes:
        for name in WATCHING:
            shares = [people.share(scene.name, name, what) for what in ("unmet", "lost")]
            present, restarts = (people.total(scene.name, name, what) for what in ("present", "restarts"))
            again = f"{1000 * restarts / present:.1f}" if name.startswith("pomdp") else ""
            rows.append([scene.name, NAMES[name], f"{100 - sum(shares):.1f}", *(f"{one:.1f}" for one in shares), again])
    made = table(["scene", "controller", "observed", "unmet", "lost", "restarts"], rows, 2)
    return "\n\n".join(["## What is missed", fill(_MISSED), made])


def _exceptions(people: People, scenes: Sequence[Scene]) -> str:
    """Every ranking that does not hold beyond doubt, and what the difference is made of."""
    lines = []
    for scene in scenes:
        for name in RIVALS:
            lead = people.lead(scene.name, name)
            if name in BOUNDS or lead.verdict > 0:
                continue
            told = f"- {scene.name}, P − {NAMES[name]} is {signed(lead)}: {_made_of(people, scene.name, name)}"
            if not lead.verdict:
                told += f"; {_decided_by(lead)}"
            if name == GUESSED:
                told += f"; {_learning(people, scene.name)}"
            lines.append(f"{told}.")
    return "\n".join(["## What does not hold, and what it is made of", "", *(lines or ["Nothing: P is above all."])])


def _made_of(people: People, scene: str, other: str) -> str:
    unmet, lost = (people.share(scene, "pomdp", what) - people.share(scene, other, what) for what in ("unmet", "lost"))
    left, gone = (f"{abs(points):.1f} {'more' if points > 0 else 'fewer'}" for points in (unmet, lost))
    return f"in shares of target-steps P leaves {left} unmet and loses {gone}"


def _decided_by(lead: Estimate) -> str:
    """How many windows an interval takes that leaves out zero, if mean and spread are what they seem."""
    windows = len(lead.samples)
    needed = windows * (lead.half_width / lead.mean) ** 2 if lead.mean else math.inf
    if needed > _MOST_WINDOWS * windows:
        return f"{windows} windows show no difference, and {_MOST_WINDOWS} times as many would not"
    return f"{windows} windows do not decide it, some {math.ceil(needed / 5) * 5:.0f} would if it is so large"


def _learning(people: People, scene: str) -> str:
    """Why motion that was learned from other people may be no better than a guess."""
    (fit,) = (one for one in people.fits if one["scene"] == scene)
    ours, guessed = (
        1000 * people.total(scene, name, "restarts") / people.total(scene, name, "present")
        for name in ("pomdp", GUESSED)
    )
    return (
        f"of the moves here {float(fit['faster']):.0f} % are faster than any speed that was learned there, and "
        f"sightings contradict the learned motion {ours:.1f} times in a thousand target-steps, the guess {guessed:.1f}"
    )


def _directions(people: People, scenes: Sequence[Scene]) -> Iterator[str]:
    """What the belief's bins of direction cost, where P was run with more of them."""
    if (scenes[0].name, FINE) not in people.windows:
        return
    told = []
    for scene in scenes:
        (fit,) = (one for one in people.fits if one["scene"] == scene.name)
        sigma, directions = float(fit["sigma_direction_deg"]), load_site(scene.site).targets.directions
        coarse, fine = (turning_deg(count, sigma) for count in (directions, FINE_DIRECTIONS))
        contradicted = [
            1000 * people.total(scene.name, name, "restarts") / people.total(scene.name, name, "present")
            for name in ("pomdp", FINE)
        ]
        coarser, static = (signed(people.lead(scene.name, other, FINE)) for other in ("pomdp", "msp"))
        told.append(
            f"- {scene.name}: learned are turns of σ = {sigma:.1f}° a step; {directions} directions make {coarse:.1f}° "
            f"of them, {FINE_DIRECTIONS} make {fine:.1f}°. P with {FINE_DIRECTIONS} minus P with {directions}: "
            f"{coarser}; minus MSP: {static}; sightings that contradict the motion, in a thousand target-steps: "
            f"{contradicted[0]:.1f} → {contradicted[1]:.1f}."
        )
    yield "\n".join(["## How many directions", "", fill(_COARSE), "", *told])


def _learned(people: People, scenes: Sequence[Scene]) -> str:
    titles = {scene.name: scene.title for scene in scenes}
    rows = []
    for fit in people.fits:
        numbers = [
            f"{float(fit[name]):.{digits}f}" for name, digits in (("sigma_direction_deg", 1), ("sigma_speed_mps", 2))
        ]
        scores = [f"{float(fit[name]):.3f}" for name in ("model", "on_grid", "random_walk", "constant_velocity")]
        others = words(titles[name] for name in fit["learned_on"].split("+"))
        speeds = fit["speeds_mps"].replace(" ", ", ")
        faster = f"{float(fit['faster']):.0f} %"
        rows.append([titles[fit["scene"]], f"{others}, {fit['people']} people", speeds, *numbers, faster, *scores])
    heads = ["for", "learned on", "speeds (m/s)", "σ direction (°)", "σ speed (m/s)", "faster"]
    made = table([*heads, "model", "on the grid", "random walk", "constant velocity"], rows, 3)
    return "\n\n".join(["## What was learned", made, fill(_FORETOLD)])
