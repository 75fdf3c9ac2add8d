"""What pydantic found wrong, put into a user's words with the place and what would be right."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from surveillance_domain.site.faults import Fault

__all__ = ["Location", "faults_of", "key_path", "shown"]

Location = tuple[str | int, ...]

_SECRET = re.compile(r"(?i)^(password|passwd|pwd|pass|secret|token|api_?key)$")
_PASSWORD_IN_URL = re.compile(r"//[^/\s]*@")
_PASSWORD_IN_QUERY = re.compile(r"(?i)((?:pass\w*|pwd)=)[^&\"]*")


def faults_of(
    error: ValidationError,
    model: type[BaseModel],
    tables: Mapping[str, Any],
    as_written: Callable[[Location], Location] = lambda location: location,
) -> tuple[Fault, ...]:
    """Every fault of ``tables`` against ``model``, each once.

    ``as_written`` tells where the reader wrote what was found at a location.
    """
    found = error.errors(include_url=False)
    inner = {one["loc"][:length] for one in found for length in range(len(one["loc"]))}
    own = [one for one in found if one["type"] != "too_short" or one["loc"] not in inner]  # short by wrong items only
    return tuple(dict.fromkeys(_fault(one, model, tables, as_written) for one in own))


def _fault(
    error: Any, model: type[BaseModel], tables: Mapping[str, Any], as_written: Callable[[Location], Location]
) -> Fault:
    location = _as_far_as_written(error["loc"], tables, error["type"] == "missing")
    where = key_path(as_written(location))
    section, field = _section(model, location)
    if error["type"] == "extra_forbidden":
        if _SECRET.match(str(location[-1])):
            return Fault(where, "a secret in the file", "the name of an environment variable, in password_env")
        return Fault(where, "an unknown key", _known_keys(section, str(location[-1])))
    described = f"a table of the keys {', '.join(section.model_fields)}" if field is None else str(field.description)
    whole = location == error["loc"]
    if error["type"] == "missing" and whole:
        if isinstance(location[-1], str):
            return Fault(where, "nothing", described)
        while isinstance(location[-1], int):  # an item of a list that is too short: the list is what is wrong
            location = location[:-1]
        where = key_path(as_written(location))
    expected = str(error["ctx"]["error"]) if error["type"] == "value_error" and whole else described
    return Fault(where, shown(_value_at(tables, location)), expected)


def _as_far_as_written(location: Location, tables: Any, missing: bool) -> Location:
    """A location without the names that pydantic gives to the branches of a union: up to the value that fits none.

    With ``missing`` the last step may be a key or an item that the file does not have.
    """
    value = tables
    for number, step in enumerate(location):
        last = missing and number == len(location) - 1
        if isinstance(value, Mapping) and isinstance(step, str):
            if step not in value:
                return location if last else location[:number]
        elif not (isinstance(value, Sequence) and not isinstance(value, str) and isinstance(step, int)):
            return location[:number]
        elif step >= len(value):
            return location if last else location[:number]
        value = value[step]
    return location


def key_path(location: Sequence[str | int]) -> str:
    """``("cameras", 1, "presets", 0, "pan")`` as ``cameras[1].presets[0].pan``."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return text.removeprefix(".")


def shown(value: Any) -> str:
    """A value as the reader wrote it, cut short, a password in an address hidden."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, dict):
        text = "a table"
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        text = "a list of tables"
    else:
        text = json.dumps(value, ensure_ascii=not value.isprintable()) if isinstance(value, str) else repr(value)
    text = _PASSWORD_IN_QUERY.sub(r"\1…", _PASSWORD_IN_URL.sub("//…@", text))
    return text if len(text) <= 60 else text[:57] + "…"


def _value_at(tables: Any, location: Location) -> Any:
    for step in location:
        tables = tables[step]
    return tables


def _nested(annotation: Any) -> type[BaseModel] | None:
    """The section that an annotation such as ``tuple[Camera, ...] | None`` speaks of, if any."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((model for part in get_args(annotation) if (model := _nested(part)) is not None), None)


def _section(model: type[BaseModel], location: Location) -> tuple[type[BaseModel], Any]:
    """The section that holds the last key of a location, and the field that the key is or belongs to.

    The field is ``None`` where no key of the location is one: the section itself is what is wrong.
    """
    field: Any = None
    for step in (step for step in location if isinstance(step, str)):
        inner = model if field is None else _nested(field.annotation)
        if inner is None or step not in inner.model_fields:  # a key of the user's own, or an unknown one
            return inner or model, field
        model, field = inner, inner.model_fields[step]
    return model, field


def _known_keys(section: type[BaseModel], key: str) -> str:
    known = list(section.model_fields)
    near = difflib.get_close_matches(key, known, n=1)
    if near:
        return f"a key of this table (did you mean {near[0]}?)"
    return f"one of this table's keys {', '.join(known)}"
