"""Changing values in a site file and nothing else: comments, order and layout stay as their author wrote them."""

from __future__ import annotations

import os
import re
import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.load import load_site

__all__ = ["rewrite_table", "with_values"]

Value = float | Sequence[float]

_HEADER = re.compile(r"""^\s*\[{1,2}\s*([A-Za-z0-9_\-."' ]+?)\s*\]{1,2}\s*(?:#.*)?$""")


def rewrite_table(path: Path, table: str, values: Mapping[str, Value]) -> None:
    """Set keys of one table of a site file; the new file is written beside the old one and then renamed.

    Parameters
    ----------
    path : Path
        A sound site file.
    table : str
        Name of a top-level table, such as ``targets``; made at the end of the file where there is none.
    values : mapping
        Numbers and lists of numbers.

    Raises
    ------
    SiteError
        If the file is not sound before or after the change, cannot be written, or writes the table in a way that
        cannot be changed line by line. The file is then as it was.
    """
    path = path.resolve()
    load_site(path)
    text = path.read_bytes().decode("utf-8")
    changed = with_values(text, table, values, str(path))
    beside = None
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(changed.encode("utf-8"))
        os.chmod(beside, path.stat().st_mode & 0o777)
        load_site(Path(beside))
        os.replace(beside, path)
    except OSError as problem:
        found = (problem.strerror or str(problem)).lower()
        raise SiteError(str(path), (Fault("", found, "a site file that can be written"),)) from None
    finally:
        if beside is not None:
            Path(beside).unlink(missing_ok=True)


def with_values(text: str, table: str, values: Mapping[str, Value], source: str = "the site file") -> str:
    """The text of a TOML file with keys of one table set.

    Raises
    ------
    SiteError
        If what comes of it would not read as the same file with just these values.
    """
    wanted = tomllib.loads(text)
    wanted[table] = {**wanted.get(table, {}), **{key: _plain(value) for key, value in values.items()}}
    newline = "\r\n" if "\r\n" in text else "\n"
    changed = _rewritten(text.splitlines(keepends=True), table, values, newline)
    try:
        agrees = tomllib.loads(changed) == wanted
    except tomllib.TOMLDecodeError:
        agrees = False
    if not agrees:
        lines = "; ".join(f"{key} = {_written(value)}" for key, value in values.items())
        expected = f"a table [{table}] with one key a line; set them by hand: {lines}"
        raise SiteError(source, (Fault(table, "a table written in another way", expected),))
    return changed


def _rewritten(lines: list[str], table: str, values: Mapping[str, Value], newline: str) -> str:
    left = dict(values)
    made: list[str] = []
    header: int | None = None
    within = False
    number = 0
    while number < len(lines):
        match = _HEADER.match(lines[number])
        if match:
            within = match[1] == table
        made.append(lines[number])
        number += 1
        if match and within:
            header = len(made)
        key = lines[number - 1].partition("=")[0].strip()
        if within and not match and key in left:
            last = number
            while last < len(lines) and _depth("".join(lines[number - 1 : last])) > 0:
                last += 1
            comment = _comment(lines[last - 1])
            indent = lines[number - 1][: len(lines[number - 1]) - len(lines[number - 1].lstrip())]
            ending = newline if lines[last - 1].endswith(("\n", "\r")) else ""
            made[-1] = f"{indent}{key} = {_written(left.pop(key))}{comment}{ending}"
            number = last
    if left:
        new = [f"{key} = {_written(value)}{newline}" for key, value in left.items()]
        if header is None:
            gap = "" if not made or made[-1].endswith(("\n", "\r")) else newline
            made += [f"{gap}{newline}[{table}]{newline}", *new]
        else:
            if not made[header - 1].endswith(("\n", "\r")):
                made[header - 1] += newline
            made[header:header] = new
    return "".join(made)


def _depth(text: str) -> int:
    """How many brackets are open at the end, comments left out."""
    bare = "\n".join(line.partition("#")[0] for line in text.splitlines())
    return bare.count("[") - bare.count("]")


def _comment(line: str) -> str:
    """The comment at the end of a line, with the space before it."""
    before, sign, after = line.rstrip("\r\n").partition("#")
    return f"{before[len(before.rstrip()) :]}{sign}{after}" if sign else ""


def _plain(value: Value) -> float | list[float]:
    return [float(one) for one in value] if isinstance(value, Sequence) else float(value)


def _written(value: Value) -> str:
    if isinstance(value, Sequence):
        return f"[{', '.join(_written(one) for one in value)}]"
    return repr(float(value))
