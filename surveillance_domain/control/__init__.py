"""The control loop, the controllers and the bounds."""
