"""Pictures of sites, runs and results."""
