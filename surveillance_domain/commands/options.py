"""What the subcommands ask for in the same words, and how it is read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from surveillance_domain.experiments.runs import TruthKind

__all__ = [
    "CellNoise",
    "DetectionProbability",
    "Overrides",
    "Progress",
    "Seed",
    "SiteName",
    "Steps",
    "Truth",
    "TruthChoice",
    "Workers",
    "input_checked",
    "overrides",
    "processors",
    "read_controllers",
    "read_counts",
    "refuse_twice",
    "truth_kind",
    "workers_checked",
]


class Truth(StrEnum):
    """How the simulated targets move."""

    grid = "grid"
    continuous = "continuous"


SiteName = Annotated[str, typer.Argument(metavar="SITE", help="A built-in site, or the path of a site file.")]
Steps = Annotated[int, typer.Option(min=1, help="Length of a run.")]
Seed = Annotated[int, typer.Option(min=0, help="Run r of a seed is the same world for every controller.")]
TruthChoice = Annotated[
    Truth,
    typer.Option("--truth", help="Targets move by the model's own chain, or in metres as in the paper's simulator."),
]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes; the result does not depend on it.")]
Progress = Annotated[
    bool | None, typer.Option("--progress/--no-progress", help="Progress on standard error; default: on a terminal.")
]
DetectionProbability = Annotated[
    float | None, typer.Option(help="Of all cameras, instead of what the site says.", show_default=False)
]
CellNoise = Annotated[
    float | None,
    typer.Option("--cell-noise-m", help="Of all cameras, instead of what the site says.", show_default=False),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("-o", "--option", metavar="KEY=VALUE", help="detection_probability=… or cell_noise_m=…, as well."),
]

_OVERRIDES = ("detection_probability", "cell_noise_m")


def overrides(
    given: Sequence[str] | None, detection_probability: float | None, cell_noise_m: float | None
) -> dict[str, float | None]:
    """The two ways to say it, put together.

    Raises
    ------
    InputError
        For a key that is not one of the two, a value that is no number, or a key given twice.
    """
    from factored_pomdp.errors import did_you_mean

    found = {"detection_probability": detection_probability, "cell_noise_m": cell_noise_m}
    for one in given or ():
        key, equals, value = one.partition("=")
        key = key.strip()
        if not equals:
            raise InputError(f"-o {one}: expected KEY=VALUE, such as detection_probability=0.8")
        if key not in _OVERRIDES:
            raise InputError(f"-o {one}: no option {key!r}{did_you_mean(key, _OVERRIDES)}")
        if found[key] is not None:
            raise InputError(f"{key} is given twice")
        try:
            found[key] = float(value)
        except ValueError:
            raise InputError(f"-o {one}: {value!r} is not a number") from None
    return found


def read_counts(text: str) -> tuple[int, ...]:
    """Numbers of targets such as ``1,5,10,20``, in ascending order.

    Raises
    ------
    InputError
        For anything that is not a whole number above 0, or stands there twice.
    """
    counts = []
    for part in text.split(","):
        try:
            counts.append(int(part))
        except ValueError:
            raise InputError(
                f"--targets {text}: {part.strip()!r} is not a whole number; expected e.g. 1,5,10,20"
            ) from None
    if min(counts) < 1:
        raise InputError(f"--targets {text}: {min(counts)} targets; expected 1 or more")
    refuse_twice("--targets", counts)
    return tuple(sorted(counts))


def read_controllers(text: str) -> tuple[str, ...]:
    """Controllers such as ``pomdp,mp``, in the order given.

    Raises
    ------
    InputError
        With what was probably meant.
    """
    from factored_pomdp.errors import did_you_mean
    from surveillance_domain.experiments.variants import VARIANTS

    names = tuple(part.strip() for part in text.split(","))
    for name in names:
        if name not in VARIANTS:
            raise InputError(f"no controller {name!r}{did_you_mean(name, VARIANTS)}")
    refuse_twice("--controllers", names)
    return names


def refuse_twice(option: str, given: Sequence[object]) -> None:
    """Raise `InputError` where something is given twice."""
    twice = [one for place, one in enumerate(given) if one in given[:place]]
    if twice:
        raise InputError(f"{option}: {twice[0]} stands there twice")


def truth_kind(truth: Truth) -> TruthKind:
    """The option as the simulation names it."""
    return "grid" if truth is Truth.grid else "continuous"


def processors() -> int:
    """How many processors this process may use."""
    import os

    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def input_checked(kinds: Iterable[type[Exception]] = (ValueError,)) -> Iterator[None]:
    """Errors that the user's input causes become one message; in here no more is done than to read and check it."""
    try:
        yield
    except InputError:
        raise
    except tuple(kinds) as problem:
        raise InputError(str(problem)) from problem


@contextmanager
def workers_checked() -> Iterator[None]:
    """A worker process that was killed from outside becomes one message."""
    from concurrent.futures.process import BrokenProcessPool

    try:
        yield
    except BrokenProcessPool:
        raise InputError("a worker process was killed, probably for want of memory: give fewer --workers") from None
