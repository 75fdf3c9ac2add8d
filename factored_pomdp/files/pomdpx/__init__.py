"""SARSOP's ``.pomdpx`` format: factored, in XML."""
