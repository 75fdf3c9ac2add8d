"""Recorded trajectories of real people: read, cleaned, resampled, and the motion model learned from them."""
