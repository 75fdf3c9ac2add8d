"""Domains that ship with the framework; each is one function that returns a model."""
