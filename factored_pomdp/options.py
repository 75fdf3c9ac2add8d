"""Options of a function, checked against its parameters and read as what its annotations ask for."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

from factored_pomdp.errors import did_you_mean

__all__ = ["checked_options"]

_NOTHING = ("none", "null", "")


def checked_options(function: Callable[..., Any], options: Mapping[str, Any], what: str) -> dict[str, Any]:
    """The options as the function takes them.

    Parameters
    ----------
    function : callable
    options : mapping
        Values of their own type, or strings to be read; ``none`` is ``None`` where the annotation allows it.
    what : str
        Whose options these are, for messages.

    Raises
    ------
    ValueError
        Names every option that is unknown, missing or of another type, and the parameters that there are.
    """
    parameters = inspect.signature(function).parameters
    named = {n: p for n, p in parameters.items() if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    open_ended = any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters.values())
    wrong, checked = [], {}
    for name, value in options.items():
        if name in named:
            try:
                checked[name] = _read(value, _annotation(function, named[name]))
            except ValueError as problem:
                wrong.append(f"option {name}={value}: {problem}")
        elif open_ended:
            checked[name] = value
        else:
            wrong.append(f"no option {name!r}{did_you_mean(name, named)}")
    for name, parameter in named.items():
        if parameter.default is parameter.empty and name not in options:
            wrong.append(f"option {name} is missing")
    if wrong:
        listed = ", ".join(str(parameter) for parameter in named.values()) or "none"
        raise ValueError(f"{what}: {'; '.join(wrong)}. Its options: {listed}")
    return checked


def _annotation(function: Callable[..., Any], parameter: inspect.Parameter) -> Any:
    """The parameter's type; ``Any`` where the annotation cannot be looked up or there is none."""
    if parameter.annotation is parameter.empty:
        return Any
    holder = SimpleNamespace(__annotations__={parameter.name: parameter.annotation})
    try:
        return typing.get_type_hints(holder, globalns=getattr(function, "__globals__", {}))[parameter.name]
    except (NameError, TypeError, AttributeError):
        return Any


def _read(value: Any, annotation: Any) -> Any:
    from pydantic import PydanticSchemaGenerationError, TypeAdapter, ValidationError

    if isinstance(value, str) and value.lower() in _NOTHING and type(None) in typing.get_args(annotation):
        return None
    try:
        return TypeAdapter(annotation).validate_python(value)
    except ValidationError as problem:
        raise ValueError(problem.errors()[0]["msg"].lower()) from None
    except PydanticSchemaGenerationError:
        return value
