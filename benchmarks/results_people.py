"""Recorded people for docs/results-people.md: learn how they walk in one scene, and watch them in another.

Positions stay in the recordings; what is written are shares of target-steps, window by window.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from results_table import write_rows

from surveillance_domain.commands.progress import progress_bar
from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.replay import prepared_replay, watched_replay
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.fitting import MotionFit, fit_motion
from surveillance_domain.trajectories.held_out import held_out_log_likelihood
from surveillance_domain.trajectories.load import load_tracks
from surveillance_domain.trajectories.staging import Placement, Stage, staged, windows
from surveillance_domain.trajectories.tracks import Track
from surveillance_domain.trajectories.transitions import transitions

SITES = Path(__file__).parent / "sites"
PEOPLE, FITS = "people.csv", "people-fits.csv"
STEPS = 40
"""Of a window, in seconds: about twice what it takes to cross a scene."""
GUESSED = "pomdp:guessed"
"""P with the hall's numbers, which are nobody's."""
FINE, FINE_DIRECTIONS = "pomdp:fine", 24
"""P with more directions than the sites have."""
WATCHING = (*COMPARED, "mp-hold", "mp-dead-reckoning", GUESSED, FINE)


@dataclass(frozen=True)
class Scene:
    """A recording and the site in which it is watched.

    Attributes
    ----------
    name, title : str
        In files; in words.
    site : Path
    recording : str
        Path below the folder of trajectories.
    frames_per_s : float
    placement : Placement
        Where the recording lies in the site; the site file says why.
    """

    name: str
    title: str
    site: Path
    recording: str
    frames_per_s: float
    placement: Placement

    def tracks(self, data: Path) -> Sequence[Track]:
        """Everybody in the recording."""
        return load_tracks(data / self.recording, Conventions(frames_per_s=self.frames_per_s)).tracks


SCENES = (
    Scene("eth", "ETH, seq_eth", SITES / "eth.toml", "ewap_seq_eth/obsmat.txt", 15.0, Placement((7.8, 3.66))),
    Scene(
        "zara01", "UCY, zara01", SITES / "zara01.toml", "ucy_zara01/obsmat.txt", 25.0, Placement((-5.0, 7.84), -90.0)
    ),
)


class Watched(NamedTuple):
    """One window under one controller; ``unmet``, ``lost``: shares of target-steps that were missed, in percent.

    Unmet: nobody has seen that person in this window so far. Lost: somebody has.
    """

    scene: str
    controller: str
    window: int
    people: int
    present: int
    percent: float
    unmet: float
    lost: float
    restarts: int
    steps: int
    seed: int


class Fit(NamedTuple):
    """What was learned for a scene on the others, and what it foretells there, in nats a step.

    ``faster``: share of the scene's moves that are faster than the fastest speed learned, in percent.
    """

    scene: str
    learned_on: str
    people: int
    sigma_direction_deg: float
    sigma_speed_mps: float
    speeds_mps: str
    model: float
    on_grid: float
    random_walk: float
    constant_velocity: float
    judged_steps: int
    faster: float


def missing(scenes: Sequence[Scene], data: Path) -> list[Path]:
    """Recordings that are not there."""
    return [data / scene.recording for scene in scenes if not (data / scene.recording).is_file()]


def learn_and_watch(scenes: Sequence[Scene], data: Path, figures: Path, seed: int, most: int | None = None) -> None:
    """Write ``people.csv`` and ``people-fits.csv``; at most ``most`` windows of each scene."""
    learned = {scene: learned_elsewhere(scene, scenes, data) for scene in scenes}
    write_rows(figures / FITS, Fit._fields, [told for _, told in learned.values()])
    pieces = {scene: _windows(scene, data, most) for scene in scenes}
    work = sum(len(WATCHING) * len(piece.people) for of in pieces.values() for piece in of)
    watched: list[Watched] = []
    with progress_bar("watching people", work, True) as advance:
        for scene, (fit, _) in learned.items():
            for controller in WATCHING:
                for number, piece in enumerate(pieces[scene]):
                    watched.append(watch(scene, fit, controller, number, piece, seed))
                    advance(len(piece.people))
    write_rows(figures / PEOPLE, Watched._fields, watched)


def learned_elsewhere(scene: Scene, scenes: Sequence[Scene], data: Path) -> tuple[MotionFit, Fit]:
    """The motion of everybody in all other scenes, and how well it foretells this one."""
    others = [other for other in scenes if other is not scene]
    tracks = [replace(one, name=f"{other.name}:{one.name}") for other in others for one in other.tracks(data)]
    site = load_site(scene.site)
    step_s = site.control.step_s
    fit = fit_motion(transitions(tracks, step_s))
    here = transitions(scene.tracks(data), step_s)
    judged = held_out_log_likelihood(fit, here, site.grid.cell_m, site.targets.directions)
    faster = 100 * float((here.moves_mps > max(fit.speeds_mps)).mean())
    speeds = " ".join(f"{speed:.2f}" for speed in fit.speeds_mps)
    people = len({track.name for track in tracks})
    learned_on = "+".join(other.name for other in others)
    scores = (judged.model, judged.on_grid, judged.random_walk, judged.constant_velocity, judged.steps, faster)
    return fit, Fit(scene.name, learned_on, people, fit.sigma_direction_deg, fit.sigma_speed_mps, speeds, *scores)


def _windows(scene: Scene, data: Path, most: int | None) -> list[Stage]:
    site = load_site(scene.site)
    stage = staged(scene.tracks(data), site.grid, scene.placement, site.control.step_s)
    return windows(stage, STEPS, most)[0]


def with_motion(site: Site, fit: MotionFit) -> Site:
    """A site whose targets move as was learned."""
    learned = {
        "speeds_mps": fit.speeds_mps,
        "sigma_direction_deg": fit.sigma_direction_deg,
        "sigma_speed_mps": fit.sigma_speed_mps,
    }
    return replace(site, targets=site.targets.model_copy(update=learned))


def watch(scene: Scene, fit: MotionFit, controller: str, number: int, piece: Stage, seed: int) -> Watched:
    """One window under one controller."""
    site = load_site(scene.site)
    name = controller.partition(":")[0]
    believed = site if controller == GUESSED else with_motion(site, fit)
    if controller == FINE:
        believed = replace(believed, targets=believed.targets.model_copy(update={"directions": FINE_DIRECTIONS}))
    replay = prepared_replay(believed, piece, name, seed, number)
    watched = watched_replay(replay)
    total = int(watched.present.sum())
    unmet, lost = (100 * int(missed.sum()) / total for missed in (watched.unmet, watched.lost))
    people, run = len(piece.people), watched.run
    return Watched(
        scene.name, controller, number, people, total, run.percent_obs, unmet, lost, run.restarts, replay.steps, seed
    )
