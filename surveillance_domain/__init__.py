"""A network of pan/tilt/zoom cameras that watches moving targets which it cannot always see: the flagship plugin."""
