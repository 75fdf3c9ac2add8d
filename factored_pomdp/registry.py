"""Domains and solvers, found through entry points; a broken plugin is named with its error and breaks nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from factored_pomdp.errors import did_you_mean
from factored_pomdp.options import checked_options

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["DomainEntry", "SolverEntry", "domain", "domain_names", "domains", "solver", "solvers"]

DOMAINS = "factored_pomdp.domains"
SOLVERS = "factored_pomdp.solvers"


@dataclass(frozen=True)
class DomainEntry:
    """An installed domain.

    Attributes
    ----------
    name : str
    summary : str
        First line of the function's description; empty where it could not be loaded.
    distribution : str
        The installed distribution that offers it, with its version.
    error : str or None
        Why it cannot be loaded.
    load : callable
        ``load()`` gives the function that builds the model; raises what importing it raises.
    """

    name: str
    summary: str
    distribution: str
    error: str | None
    load: Callable[[], Callable[..., FactoredPOMDP]] = field(repr=False)


@dataclass(frozen=True)
class SolverEntry:
    """An installed solver; attributes as `DomainEntry`, ``load()`` gives the class."""

    name: str
    summary: str
    distribution: str
    error: str | None
    load: Callable[[], Any] = field(repr=False)


def domains() -> list[DomainEntry]:
    """Every installed domain, by name."""
    return [DomainEntry(*found) for found in _entries(DOMAINS)]


def domain_names() -> list[str]:
    """Names of the installed domains, none of which is loaded for it."""
    return list(dict.fromkeys(point.name for point in _points(DOMAINS)))


def solvers() -> list[SolverEntry]:
    """Every installed solver, by name."""
    return [SolverEntry(*found) for found in _entries(SOLVERS)]


def domain(name: str, **options: Any) -> FactoredPOMDP:
    """Build an installed domain's model.

    Parameters
    ----------
    name : str
    **options
        Parameters of the domain's function. Strings are read as what the function's annotations ask for.

    Raises
    ------
    ValueError
        Unknown domain, unknown option, value of another type; what the domain itself raises goes through.
    """
    function = _load(DOMAINS, name)
    return function(**checked_options(function, options, f"domain {name!r}"))


def solver(name: str) -> Any:
    """The class of an installed solver."""
    return _load(SOLVERS, name)


def _load(group: str, name: str) -> Any:
    what = group.rpartition(".")[2].removesuffix("s")
    found = {point.name: point for point in reversed(_points(group))}
    if name not in found:
        raise ValueError(f"no {what} {name!r} is installed{did_you_mean(name, sorted(found))}")
    try:
        return found[name].load()
    except (Exception, SystemExit) as problem:
        raise ValueError(f"{what} {name!r} ({_origin(found[name])}) cannot be loaded: {_said(problem)}") from problem


def _entries(group: str) -> list[tuple[str, str, str, str | None, Callable[[], Any]]]:
    found = []
    points = _points(group)
    first = {point.name: point for point in reversed(points)}
    for point in points:
        summary, error = "", None
        if first[point.name] is not point:
            error = f"the name is taken by {_origin(first[point.name])}"
        else:
            try:
                summary = _first_line(point.load())
            except (Exception, SystemExit) as problem:  # a plugin may say exit()
                error = _said(problem)
        found.append((point.name, summary, _origin(point), error, point.load))
    return found


def _points(group: str) -> list[Any]:
    from importlib.metadata import entry_points

    unique = {(point.name, point.value): point for point in reversed(list(entry_points(group=group)))}
    return sorted(unique.values(), key=lambda point: (point.name, _origin(point)))


def _origin(point: Any) -> str:
    return f"{point.dist.name} {point.dist.version}" if point.dist is not None else "unknown distribution"


def _said(problem: BaseException) -> str:
    return f"{type(problem).__name__}: {problem}"


def _first_line(described: Any) -> str:
    summary = getattr(described, "summary", None) or (described.__doc__ or "").strip()
    return str(summary).partition("\n")[0]
