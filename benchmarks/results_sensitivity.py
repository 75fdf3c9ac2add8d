"""What is simulated for docs/results-sensitivity.md: the sites with one parameter changed.

Targets and beliefs change alike, so that only the problem is another; with walls and direction there is a misfit, too:
targets move by the variant, and the controller still believes in the site as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import tomlkit
from results_plan import KNOWN_COUNT, KNOWN_RUNS, Extent, key
from results_runs import KNOWS, UNAWARE, Simulated, Wanted, base_of, variant_name
from results_table import Results, read_rows, write_text

from surveillance_domain.experiments.setup import Case, Setup

SENSITIVITY = "sensitivity.csv"
AGAINST = ("mp", "msp", "sys", "stat", "full-information")
MISLED = ("pomdp", "msp")
"""Controllers that are also run with a wrong idea of the motion."""
Slices = dict[tuple[str, str], Results]
"""Results by parameter and value."""


@dataclass(frozen=True)
class Parameter:
    """Something of a site that is changed.

    Attributes
    ----------
    name, title : str
        In files and tables; in words.
    values : tuple of str
        In order.
    own : str or None
        That of the site files, which the comparison has; ``None`` if none of the values is theirs.
    change : callable
        Changes a site file as a document to a value.
    misfit : bool
        Whether controllers are also run that do not know of the change.
    """

    name: str
    title: str
    values: tuple[str, ...]
    own: str | None
    change: Callable[[Any, str], None]
    misfit: bool = False

    @property
    def changed(self) -> tuple[str, ...]:
        """Values that the site files do not have."""
        return tuple(value for value in self.values if value != self.own)


def _walls(site: Any, value: str) -> None:
    site["targets"]["walls"] = value


def _sigma_direction(site: Any, value: str) -> None:
    site["targets"]["sigma_direction_deg"] = float(value)


def _sigma_speed(site: Any, value: str) -> None:
    site["targets"]["speeds_mps"] = [1.0, 1.5, 2.0]
    site["targets"]["sigma_speed_mps"] = float(value)


def _depth(site: Any, value: str) -> None:
    """d_max = width / (2 · px_per_m · tan(hfov / 2)): the depth goes with the inverse of the pixels required."""
    scales = {"required_px_per_m": 1 / float(value), "max_depth_m": float(value)}
    for name, scale in scales.items():
        if name in site["defaults"]:
            site["defaults"][name] = float(site["defaults"][name]) * scale


PARAMETERS = (
    Parameter("walls", "what walls do to a move", ("reject", "reflect", "stay"), "reject", _walls, True),
    Parameter("sigma-direction", "σ of the direction (degrees)", ("15", "30", "60"), "30", _sigma_direction, True),
    Parameter("sigma-speed", "σ of the speed (m/s)", ("0", "0.2", "0.5"), None, _sigma_speed),
    Parameter("depth", "depth of the fields of view", ("0.75", "1", "1.25"), "1", _depth),
)


def variants(extent: Extent, folder: Path, seed: int, runs: int) -> Iterator[tuple[tuple[str, str], Wanted]]:
    """Parameter and value, with each case; the site files are written to the folder."""
    for parameter in PARAMETERS:
        for value in parameter.changed:
            for site in extent.sites:
                path = str(_written(folder, site, parameter, value))
                for count in extent.few_counts:
                    for controller in _controllers(parameter):
                        case = Case(Setup(path, count), controller, "grid", extent.steps, seed)
                        yield (parameter.name, value), (case, runs)
                for name in MISLED:
                    case = Case(Setup(path, KNOWN_COUNT), name + KNOWS, "grid", extent.steps, seed)
                    yield (parameter.name, value), (case, min(KNOWN_RUNS, runs))


def _controllers(parameter: Parameter) -> tuple[str, ...]:
    misled = tuple(name + UNAWARE for name in MISLED) if parameter.misfit else ()
    return ("pomdp", *AGAINST, *misled)


def _written(folder: Path, site: str, parameter: Parameter, value: str) -> Path:
    """A built-in site's file, with a parameter changed."""
    builtin = resources.files("surveillance_domain.site") / "builtin" / f"{site}.toml"
    document = tomlkit.parse(builtin.read_text(encoding="utf-8"))
    parameter.change(document, value)
    path = folder / variant_name(site, parameter.name, value)
    write_text(path, tomlkit.dumps(document))
    return path


def rows(made: dict[Case, tuple[str, str]], simulated: Simulated) -> Iterator[tuple[object, ...]]:
    """A row for each run: parameter, value, key, PercentObs (or the share known), restarts."""
    for case, parameter_and_value in made.items():
        for number, run in sorted(simulated[case].items()):
            name = key(case, number, base_of(case.setup.site))
            yield *parameter_and_value, *name, run.percent_obs, run.restarts


def read_slices(figures: Path, comparison: Results) -> Slices:
    """Results of every value of every parameter; those of the sites' own values are the comparison's first runs."""
    found = read_rows(figures / SENSITIVITY)
    slices: Slices = {}
    for parameter in PARAMETERS:
        for value in parameter.changed:
            of = [row for row in found if (row["parameter"], row["value"]) == (parameter.name, value)]
            slices[parameter.name, value] = Results.of(of)
        if parameter.own is not None:
            slices[parameter.name, parameter.own] = comparison.first(slices[parameter.name, parameter.changed[0]].runs)
    return slices


def places(slices: Slices) -> list[tuple[str, int]]:
    """Site and number of targets of every case."""
    return [panel[1:] for panel in slices[PARAMETERS[0].name, PARAMETERS[0].changed[0]].panels]
