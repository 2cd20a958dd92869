"""Calibration of the camera from the page: ``job`` (one process at a time), ``settings_of`` a result."""
