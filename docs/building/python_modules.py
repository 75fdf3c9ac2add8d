"""The Python reference: a mkdocstrings block for every name that a module offers."""

from __future__ import annotations

from importlib import import_module

__all__ = ["offered", "python_reference"]


def offered(module: str) -> tuple[str, ...]:
    """Names that a module offers in its ``__all__``; none where it has no such list."""
    return tuple(getattr(import_module(module), "__all__", ()))


def python_reference(*modules: str) -> str:
    """Markdown for mkdocstrings: what the modules offer, in their order."""
    return "\n\n".join(f"::: {module}.{name}" for module in modules for name in offered(module))
