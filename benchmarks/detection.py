"""How often markers are found in emulated pictures, and how far off: with distance, and on a site with its robots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.report import Aim, Report
from surveillance_domain.cameras.base import Position
from surveillance_domain.emulation.rendering import Renderer
from surveillance_domain.model.looks import looks
from surveillance_domain.model.pinhole import Pinhole, pinhole
from surveillance_domain.model.views import build_views
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Markers
from surveillance_domain.site.site import Site
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.ground import Ground, ground
from surveillance_domain.vision.marker_size import LEAST_SIDE_PX, marker_sides_px
from surveillance_domain.vision.observe import Located, located
from surveillance_domain.vision.opencv import decoded

__all__ = ["detection"]

HEIGHTS_M = (1.2, 2.7)
DISTANCES_M = (1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0)
COUNTS = (1, 2, 3, 4, 5)
_ROOM_M = 0.25
"""Between the middles of two robots, at least: their own breadth and a bit."""


@dataclass
class Tally:
    """Targets in view, which were found, how far off in metres, and whether in the right cell."""

    shown: int = 0
    off_m: list[float] = field(default_factory=list)
    right_cell: int = 0
    wrong: int = 0

    def add(self, site: Site, places: np.ndarray, counted: np.ndarray, found: Sequence[Located]) -> None:
        by_identity = {one.detection.identity: one for one in found}
        self.wrong += sum(one.detection.identity not in range(len(places)) for one in found)
        self.shown += int(counted.sum())
        for number in np.flatnonzero(counted):
            one = by_identity.get(int(number))
            if one is not None:
                self.off_m.append(float(np.hypot(*(np.array(one.point_m) - places[number]))))
                self.right_cell += one.cell == tuple(site.grid.cell_at(places[number]).tolist())

    def figures(self) -> dict[str, Any]:
        from scipy.stats import binomtest

        off = np.array(self.off_m)
        interval = binomtest(len(off), self.shown).proportion_ci(method="wilson") if self.shown else None
        return {
            "shown": self.shown,
            "rate": len(off) / self.shown if self.shown else None,
            "ci95": None if interval is None else [float(interval.low), float(interval.high)],
            "rms_m": float(np.sqrt(np.mean(off**2))) if len(off) else None,
            "worst_m": float(off.max()) if len(off) else None,
            "right_cell": self.right_cell / len(off) if len(off) else None,
            "wrong_identities": self.wrong,
        }


def detection(quick: bool, seed: int, site: str = "lego", pictures: int = 200) -> Report:
    """One marker in plain view at random headings, by distance and camera height; then all robots of a site.

    On the site, robots stand at random places, a quarter of a metre apart; those count whose cell is in the camera's
    view, as the model has it, so the rate is the model's ``detection_probability``. They hide each other, and the edge
    of the picture cuts some.
    """
    found, rng = load_site(site), np.random.default_rng(seed)
    number = pictures // 20 if quick else pictures
    rows, distances = [], []
    for height in HEIGHTS_M:
        for distance in DISTANCES_M[:: 3 if quick else 1]:
            side_px, tally = _plain_view(found, height, distance, number, rng)
            figures = {"height_m": height, "distance_m": distance, "side_px": side_px, **tally.figures()}
            distances.append(figures)
            rows.append([f"camera {height:g} m up, {distance:g} m away", f"{side_px:.0f}", *_cells(figures)])
    on_site = []
    for count in COUNTS[:: 4 if quick else 1]:
        for camera, tally in _robots(found, count, number, rng).items():
            figures = {"robots": count, "camera": camera, **tally.figures()}
            on_site.append(figures)
            rows.append([f"{site}, {count} robots, {camera}", "", *_cells(figures)])
    plain = [one for one in distances if one["side_px"] >= LEAST_SIDE_PX]
    shown = sum(one["shown"] for one in plain)
    rate = sum(one["rate"] * one["shown"] for one in plain) / shown
    return Report(
        "Markers found in emulated pictures",
        ["where", "side, px", "shown", "found", "95 %", "off, rms", "right cell"],
        rows,
        {"plain_view": distances, "on_site": on_site, "seed": seed},
        aims=[Aim(f"markers of {LEAST_SIDE_PX:g} px and more found in plain view", rate, 0.99, at_least=True)],
    )


def _cells(figures: dict[str, Any]) -> list[str]:
    if not figures["shown"]:
        return ["0", "", "", "", ""]
    off, right = figures["rms_m"], figures["right_cell"]
    low, high = figures["ci95"]
    shown = [f"{figures['shown']:,}", f"{figures['rate']:.1%}", f"{low:.1%} to {high:.1%}"]
    return [*shown, "" if off is None else f"{1000 * off:.1f} mm", "" if right is None else f"{right:.1%}"]


def _markers(site: Site) -> Markers:
    if site.markers is None:
        raise ValueError(f"site {site.name} has no markers")
    return site.markers


def _plain_view(
    site: Site, height_m: float, distance_m: float, pictures: int, rng: np.random.Generator
) -> tuple[float, Tally]:
    """One marker somewhere near the middle of the picture, anywhere in a cell."""
    tilt = -float(np.degrees(np.arctan2(height_m, distance_m)))
    renderer, detector = Renderer(site, looks(site, 1), rng.spawn(1)[0]), MarkerDetector(_markers(site))
    tally = Tally()
    for _ in range(pictures):
        at = Position(float(rng.uniform(-12, 12)), tilt + float(rng.uniform(-6, 6)), 1.0)
        places = _scattered(site, 1, rng)
        view, here = _seen(_camera_before(site, places[0], height_m, distance_m), at)
        picture = decoded(renderer.jpeg(view, places, rng.uniform(0, 2 * np.pi, 1)))
        tally.add(site, places, np.ones(1, dtype=bool), located(here, site.grid, detector.detect(picture)))
    view, _ = _seen(_camera_before(site, np.zeros(2), height_m, distance_m), Position(0.0, tilt, 1.0))
    return float(marker_sides_px(view, _markers(site), np.zeros((1, 2)))[0]), tally


def _camera_before(site: Site, place_m: np.ndarray, height_m: float, distance_m: float) -> Camera:
    """The site's first camera, hung at some distance south of a place and looking north."""
    x, y = place_m.tolist()
    mount = {"position_m": (x, y - distance_m, height_m), "yaw_deg": 90.0}
    camera = site.cameras[0]
    return camera.model_copy(update={"mount": camera.mount.model_copy(update=mount)})


def _robots(site: Site, count: int, pictures: int, rng: np.random.Generator) -> dict[str, Tally]:
    """All cameras at random presets of theirs, over robots at random places."""
    views = build_views(site)
    renderer, detector = Renderer(site, looks(site, count), rng.spawn(1)[0]), MarkerDetector(_markers(site))
    tallies = {name: Tally() for name in (*(camera.name for camera in site.cameras), "all cameras")}
    for _ in range(pictures):
        places, headings = _scattered(site, count, rng), rng.uniform(0, 2 * np.pi, count)
        cells = site.grid.number_at(places)
        for number, camera in enumerate(site.cameras):
            chosen = int(rng.integers(len(camera.presets)))
            preset = camera.presets[chosen]
            view, here = _seen(camera, Position(preset.pan, preset.tilt, preset.zoom))
            picture = decoded(renderer.jpeg(view, places, headings))
            counted = views.detection[number][chosen][cells] > 0
            seen = located(here, site.grid, detector.detect(picture))
            for name in (camera.name, "all cameras"):
                tallies[name].add(site, places, counted, seen)
    return tallies


def _scattered(site: Site, count: int, rng: np.random.Generator) -> np.ndarray:
    """Places on free cells, none nearer than `_ROOM_M` to another."""
    places: list[np.ndarray] = []
    while len(places) < count:
        centre = site.grid.centres_m[rng.integers(site.grid.size)]
        place = centre + site.grid.cell_m * rng.uniform(-0.5, 0.5, 2)
        if all(np.hypot(*(place - other)) >= _ROOM_M for other in places):
            places.append(place)
    return np.array(places)


def _seen(camera: Camera, at: Position) -> tuple[Pinhole, Ground]:
    view = pinhole(camera, at.pan, at.tilt, 1.0 if at.zoom is None else at.zoom)
    return view, ground(camera, at, (view.width, view.height))
