"""``surveillance replay-run``: a recorded watch, shown again."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer
from surveillance_domain.commands.recorded import lines_of, model_of

if TYPE_CHECKING:
    from surveillance_domain.control.replaying import Refilter
    from surveillance_domain.model.build import Surveillance
    from surveillance_domain.model.elsewhere import Elsewhere
    from surveillance_domain.pictures.scene import Frame

__all__ = ["replay_run"]

_MOST_FRAMES = 2000


def replay_run(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="A record's folder, or one of its files.")],
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="An animation, such as run.gif.")] = None,
    first: Annotated[int, typer.Option(min=1, help="Number of the first step to show.")] = 1,
    last: Annotated[int | None, typer.Option(min=1, help="Number of the last step to show.")] = None,
    pace: Annotated[float, typer.Option(min=0, help="Seconds to wait after each step.")] = 0.0,
    as_json: AsJson = False,
) -> None:
    """Show the last run of a record again: a line a step, and an animation with the belief as it was."""
    from surveillance_domain.control.replaying import Refilter
    from surveillance_domain.model.elsewhere import Elsewhere

    if out is not None and out.suffix.lower() != ".gif":
        raise InputError(f"--out {out}: expected the name of a .gif file")
    if last is not None and last < first:
        raise InputError(f"--first {first} --last {last}: expected a first step up to the last")
    header = _last_header(record)
    surveillance = model_of(header)
    refilter, elsewhere = Refilter(surveillance), Elsewhere(surveillance.site)
    shares = _Share()
    frames: deque[Frame] = deque(maxlen=_MOST_FRAMES)
    shown = 0
    for step in _steps(record, header["run"]):
        if last is not None and step["step"] > last:
            break
        refilter.take(step)
        shares.take(step)
        if step["step"] < first:
            continue
        shown += 1
        if not as_json:
            answer({}, [_line(step, shares)], as_json=False)
            time.sleep(pace)
        if out is not None:
            frames.append(_frame(step, surveillance, refilter, shares, elsewhere))
    if not shown:
        raise InputError(f"{record}: no step {first}" + (f" to {last}" if last is not None else " or later"))
    if out is not None:
        _animate(out, surveillance, frames, header)
    told = [] if out is None else [f"Written to {out}"]
    content = {"record": str(record), "site": header["site"], "run": header["run"], "steps": shown}
    answer({**content, "percent_obs": shares.percent, "out": None if out is None else str(out)}, told, as_json=as_json)


class _Share:
    """PercentObs so far, where the truth was recorded."""

    def __init__(self) -> None:
        self._sum, self._count = 0.0, 0

    def take(self, step: Mapping[str, Any]) -> None:
        present = sum(place is not None for place in step.get("truth_m", ()))
        if present:
            self._sum, self._count = self._sum + _seen(step) / present, self._count + 1

    @property
    def percent(self) -> float | None:
        return 100 * self._sum / self._count if self._count else None


def _last_header(record: Path) -> dict[str, Any]:
    found = None
    for line in lines_of(record):
        if line["kind"] == "header":
            found = line
    if found is None:
        raise InputError(f"{record}: a record without a header; give the folder with all of its files")
    return found


def _steps(record: Path, run: str) -> Iterator[dict[str, Any]]:
    """The steps of one run, in all its files."""
    inside = False
    for line in lines_of(record):
        if line["kind"] == "header":
            inside = line["run"] == run
        elif inside and line["kind"] == "step":
            yield line


def _seen(step: Mapping[str, Any]) -> int:
    return sum(cell is not None for cell in step["observations"].values()) + len(step["unknown"])


def _line(step: Mapping[str, Any], shares: _Share) -> str:
    places = {
        camera: f"pan {pan:.0f}°, tilt {tilt:.0f}°" for camera, (pan, tilt, _) in step.get("elsewhere", {}).items()
    }
    views = ", ".join(f"{camera} {view or places.get(camera, '—')}" for camera, view in step["views"].items())
    seen, beyond = {**step["observations"], **step["unknown"]}, step.get("beyond", {})
    mark = {target: f" (beyond the view of {camera})" for target, camera in beyond.items()}
    where = ", ".join(f"{t} {cell[0]},{cell[1]}{mark.get(t, '')}" for t, cell in seen.items() if cell is not None)
    percent = "" if shares.percent is None else f"  {shares.percent:.1f} %"
    return f"{step['step']:>6}  {step['time_s']:9.1f} s{percent}  {views}  |  {where or 'nobody seen'}"


def _frame(
    step: Mapping[str, Any], surveillance: Surveillance, refilter: Refilter, shares: _Share, elsewhere: Elsewhere
) -> Frame:
    import numpy as np

    from surveillance_domain.pictures.scene import Frame

    grid, cameras = surveillance.site.grid, surveillance.site.cameras
    names = [[preset.name for preset in camera.presets] for camera in cameras]
    views = [step["views"][camera.name] for camera in cameras]
    presets = tuple(None if view is None else own.index(view) for view, own in zip(views, names, strict=True))
    seen = {**step["observations"], **step["unknown"]}
    cells = [cell for cell in seen.values() if cell is not None]
    positions = np.array([grid.centres_m[grid.number[row, column]] for column, row in cells]).reshape(-1, 2)
    observed = np.ones(len(cells), dtype=bool)
    if "truth_m" in step:
        positions = np.array([place or (np.nan, np.nan) for place in step["truth_m"]], dtype=float).reshape(-1, 2)
        observed = np.array([seen.get(name) is not None for name in _names(surveillance, len(positions))])
    expected = np.zeros(grid.size)
    for target in refilter.targets:
        expected += refilter.belief.marginal(f"{target}.location")[: grid.size]
    percent = math.nan if shares.percent is None else shares.percent
    places = {number: refilter.elsewhere.get(camera.name) for number, camera in enumerate(cameras)}
    fields = {n: elsewhere.detection(cameras[n].name, place) for n, place in places.items() if place is not None}
    seen_there = {number: field > 0 for number, field in fields.items() if field is not None}
    return Frame(step["step"], positions, observed, presets, expected, percent, seen_there)


def _names(surveillance: Surveillance, there: int) -> list[str]:
    """What the targets that were truly there are called, when seen; those beyond the model by their markers."""
    from surveillance_domain.model.looks import looks

    strangers = looks(surveillance.site, there)[len(surveillance.targets) :]
    return [
        *surveillance.targets,
        *(look.name if look.marker is None else f"marker {look.marker}" for look in strangers),
    ]


def _animate(out: Path, surveillance: Surveillance, frames: deque[Frame], header: Mapping[str, Any]) -> None:
    from surveillance_domain.pictures.animation import write_animation

    heading = (
        f"{header['site']}, controller {header['controller']}, recorded {header['run'][:16].replace('T', ' ')} UTC"
    )
    try:
        write_animation(surveillance.site, surveillance.views, list(frames), heading, out)
    except OSError as problem:
        raise InputError(f"--out {out}: {(problem.strerror or str(problem)).lower()}") from None
