"""The live page of a watch, for any number of browsers."""
