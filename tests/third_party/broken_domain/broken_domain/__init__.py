"""A plugin that raises when it is imported."""

raise RuntimeError("this plugin was written for another version")
