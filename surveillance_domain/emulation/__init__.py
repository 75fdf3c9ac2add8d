"""Emulated AXIS cameras: real HTTP servers on loopback with motors, faults, and pictures of a truth of their own."""
