"""What ``surveillance learn`` answers: JSON, tables, and sentences that say what the numbers mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import COMMAND_LINE, table
from surveillance_domain.commands.recordings import count_lines, digest_of

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.trajectories.learning import Learned, Wanted
    from surveillance_domain.trajectories.prior import CellPrior, PlacedPrior
    from surveillance_domain.trajectories.tracks import Tracks

__all__ = ["carried", "learned_content", "shown_learned"]

_RIVALS = {"random_walk": "a random walk", "constant_velocity": "constant velocity"}


def learned_content(
    found: Mapping[Path, Tracks],
    passed_over: Sequence[str],
    learned: Learned,
    wanted: Wanted,
    placed: PlacedPrior | None,
) -> dict[str, Any]:
    """What was learned and how it was judged, and the prior as it was placed into a site.

    Parameters
    ----------
    found : mapping of Path to Tracks
    passed_over : sequence of str
        Which files were not used, and why.
    learned : Learned
    wanted : Wanted
    placed : PlacedPrior or None
    """
    from functools import reduce
    from operator import add

    fit, prior = learned.fit, learned.prior
    return {
        "sigma_direction_deg": fit.sigma_direction_deg,
        "sigma_speed_mps": fit.sigma_speed_mps,
        "mean_speed_mps": fit.mean_speed_mps,
        "speeds": list(fit.speeds_mps),
        "trajectories": sum(len(one.people) for one in found.values()),
        "steps": len(learned.everyone.moves_mps),
        "turns": len(learned.everyone.turns_rad),
        "step_s": fit.step_s,
        "held_out_log_likelihood": learned.judged.model,
        "held_out": _held_out(learned, wanted),
        "prior": None
        if prior is None
        else {"origin_m": prior.origin_m, "cell_m": prior.cell_m, "rows_from_below": prior.probability.tolist()},
        "prior_in_site": None
        if placed is None
        else {key: value for key, value in vars(placed).items() if key != "probability"},
        "counts": reduce(add, (one.counts for one in found.values())).as_dict(),
        "recorded_every_s": {str(path): one.frame_s for path, one in found.items()},
        "warnings": [
            *passed_over,
            *(f"{path}: {warning}" for path, one in found.items() for warning in one.warnings),
        ],
        "faults": [{"file": str(path), **asdict(fault)} for path, one in found.items() for fault in one.findings],
    }


def carried(found: Mapping[Path, Tracks], seed: int) -> dict[str, Any]:
    """Where it comes from."""
    from factored_pomdp.provenance import provenance

    return provenance(COMMAND_LINE.get(), {str(path): digest_of(path) for path in found}, seed)


def _held_out(learned: Learned, wanted: Wanted) -> dict[str, Any]:
    from surveillance_domain.commands.folder import finite
    from surveillance_domain.trajectories.held_out import verdict

    judged = learned.judged
    gains = {"random_walk": judged.over_random_walk, "constant_velocity": judged.over_constant_velocity}
    return {
        "unit": "nats a step, of the cell of the next position",
        "model": judged.model,
        "on_grid": judged.on_grid,
        "random_walk": judged.random_walk,
        "constant_velocity": judged.constant_velocity,
        **{f"model_over_{name}_ci95": [finite(end) for end in gain] for name, gain in gains.items()},
        "verdict": {name: verdict(gain) for name, gain in gains.items()},
        "steps": judged.steps,
        "trajectories": judged.people,
        "sigma_direction_deg": learned.judged_fit.sigma_direction_deg,
        "sigma_speed_mps": learned.judged_fit.sigma_speed_mps,
        "speeds": list(learned.judged_fit.speeds_mps),
        "cell_m": wanted.cell_m,
        "directions": wanted.directions,
        "impossible_on_grid": judged.impossible,
    }


def shown_learned(
    content: Mapping[str, Any], prior: CellPrior | None, placed: PlacedPrior | None
) -> list[RenderableType]:
    """Two tables, and what they say."""
    rows = table("learned", "found", right=["found"])
    rows.add_row("sigma of the direction, a step", f"{content['sigma_direction_deg']:.2f}°")
    rows.add_row("sigma of the speed, a step", f"{content['sigma_speed_mps']:.3f} m/s")
    rows.add_row("speeds", ", ".join(f"{speed:g}" for speed in content["speeds"]) + " m/s")
    rows.add_row("mean speed", f"{content['mean_speed_mps']:.3f} m/s")
    if prior is not None:
        rows.add_row("prior over cells", _prior_line(prior))
    if placed is not None:
        rows.add_row("  in the site", _placed_line(placed))
    rows.add_row("people; steps", f"{content['trajectories']:,}; {content['steps']:,}")
    for name, number in count_lines(content["counts"]):
        rows.add_row(f"  {name}", number)
    shown: list[RenderableType] = [rows, _scores(content["held_out"]), *_sentences(content)]
    if content["written"]:
        shown.append(f"Written: {', '.join(content['written'])}")
    return shown


def _prior_line(prior: CellPrior) -> str:
    from surveillance_domain.trajectories.prior import cells_of_half

    height, width = prior.probability.shape
    half = cells_of_half(prior.probability)
    return f"{width:,} x {height:,} cells of {prior.cell_m:g} m; half of the time in {half:,} of them"


def _placed_line(placed: PlacedPrior) -> str:
    from surveillance_domain.trajectories.prior import cells_of_half

    reach = f"; {placed.out_of_reach:,} that nobody can walk to have none" if placed.out_of_reach else ""
    return f"half of it in {cells_of_half(placed.probability):,} of {len(placed.probability):,} free cells{reach}"


def _scores(judged: Mapping[str, Any]) -> RenderableType:
    heading = f"held out: {judged['trajectories']:,} people, {judged['steps']:,} steps"
    numbers = ("nats a step", "the model's gain", "95 % interval")
    scores = table(heading, *numbers, "the model is", right=numbers)
    scores.add_row("velocity-direction model", f"{judged['model']:.3f}")
    scores.add_row(f"the same on the grid, {judged['directions']} directions", f"{judged['on_grid']:.3f}")
    for name, words in _RIVALS.items():
        gain = f"{judged['model'] - judged[name]:+.3f}"
        interval = _interval(judged[f"model_over_{name}_ci95"])
        scores.add_row(words.removeprefix("a "), f"{judged[name]:.3f}", gain, interval, judged["verdict"][name])
    return scores


def _interval(ends: Sequence[float | None]) -> str:
    low, high = ends
    return "unknown" if low is None or high is None else f"{low:+.3f} to {high:+.3f}"


def _sentences(content: Mapping[str, Any]) -> list[str]:
    judged = content["held_out"]
    told = []
    for name, words in _RIVALS.items():
        ends, word = judged[f"model_over_{name}_ci95"], judged["verdict"][name]
        if ends[0] is None:
            told.append(f"beside {words} undecided, since one person alone was held out")
        elif word == "undecided":
            told.append(f"beside {words} undecided, since the interval of its gain holds zero")
        else:
            told.append(f"{word} than {words}")
    price = judged["model"] - judged["on_grid"]
    speeds = "1 speed" if len(content["speeds"]) == 1 else f"{len(content['speeds'])} speeds"
    return [
        f"The learned model foretells the next cell {told[0]}; {told[1]}.",
        f"On the grid is what the cameras' belief makes of it, from the nearest of {judged['directions']} directions "
        f"and of {speeds} on cells of {judged['cell_m']:g} m: "
        f"{abs(price):.3f} nats a step {'less' if price >= 0 else 'more'} than without that rounding.",
    ]
