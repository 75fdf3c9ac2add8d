"""Cassandra's ``.pomdp`` format: flat, and nearly every solver's own."""
