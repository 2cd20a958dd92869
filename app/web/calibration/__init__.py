"""Calibration of the camera from the page: ``job``, a process of its own, one at a time."""
