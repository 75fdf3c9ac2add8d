"""Motion, optics, fields of view, and the factored POMDP that they make."""
