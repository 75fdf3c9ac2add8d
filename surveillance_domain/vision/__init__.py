"""From pictures to observations: detectors, the way from pixels to the floor and its cells, and calibration."""
