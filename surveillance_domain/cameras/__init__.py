"""Pan/tilt/zoom cameras as the control loop meets them, and the driver for AXIS cameras (VAPIX over HTTP)."""
