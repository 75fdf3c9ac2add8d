"""Tables of a site file's keys, read off the schema that checks site files."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

__all__ = ["site_keys"]


def site_keys(section: str) -> str:
    """Markdown table of one section of the schema: key, what is right, default.

    Parameters
    ----------
    section : str
        Name of a class of the schema, such as ``Camera``.
    """
    from surveillance_domain.site import camera, schema, sections

    model = next(getattr(module, section) for module in (schema, sections, camera) if hasattr(module, section))
    rows = [f"| `{name}` | {_right(field)} | {_default(field)} |" for name, field in model.model_fields.items()]
    return "\n".join(["| key | what is right | default |", "|---|---|---|", *rows])


def _right(field: FieldInfo) -> str:
    """A description, with what Markdown would take for its own written otherwise."""
    return (field.description or "").translate(str.maketrans({"|": "&#124;", "{": "&#123;", "[": "&#91;"}))


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value: Any = field.get_default(call_default_factory=True)
    if value is None or isinstance(value, BaseModel) or value == ():
        return ""
    return f"`{json.dumps(value, ensure_ascii=False)}`"
