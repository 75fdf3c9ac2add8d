"""The figure of docs/results-people.md: what each controller observed of recorded people, window by window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from results_people import STEPS, WATCHING, Scene
from results_people_text import NAMES, People

from surveillance_domain.experiments.variants import BOUNDS
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, save_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, _, _, _, SKY, _ = CAMERA_COLOURS


def draw_people(people: People, scenes: Sequence[Scene], folder: Path) -> None:
    """``people`` as PNG and SVG."""
    save_figure(_draw(people, scenes), folder / "people.png")


@styled
def _draw(people: People, scenes: Sequence[Scene]) -> Figure:
    """A panel for each scene: bars with intervals, a dot for each window."""
    figure = new_figure(4.6 * len(scenes) + 1, 3.9)
    all_axes = figure.subplots(1, len(scenes), sharey=True, squeeze=False)[0]
    for axes, scene in zip(all_axes, scenes, strict=True):
        for place, name in enumerate(WATCHING):
            share = people.mean(scene.name, name)
            ours = name.startswith("pomdp")
            colour = BLUE if name == "pomdp" else SKY if ours else "#e3e3e3" if name in BOUNDS else "#b5b5b5"
            axes.barh(place, share.mean, color=colour, xerr=share.half_width, ecolor=INK, capsize=3)
            axes.plot(share.samples, [place] * len(share.samples), ".", color=INK, markersize=3, alpha=0.5)
        count = len(people.windows[scene.name, "pomdp"])
        axes.set_title(f"{scene.title}: {count} windows of {STEPS} s", fontsize=10, fontweight="bold")
        axes.set_xlabel("PercentObs (% of people on the map observed)")
        axes.set_xlim(0, 100)
        axes.grid(axis="x", color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    all_axes[0].set_yticks(range(len(WATCHING)), labels=[NAMES[name] for name in WATCHING])
    all_axes[0].invert_yaxis()
    figure.supxlabel("dots: windows; bars: 95 % confidence of the mean; motion learned on the other scene", fontsize=8)
    return figure
