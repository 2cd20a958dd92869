"""A constant-velocity Kalman filter (white-noise acceleration), for one axis or several alike.

State per axis: value and rate. Acceleration is white noise of spectral density q, so that over a time t

    F = [1 t; 0 1],   Q = q [t^3/3  t^2/2; t^2/2  t]        (Bar-Shalom et al. 2001, section 6.2.2)

Q composes: two steps of t/2 give what one step of t gives, whatever the frame rate. Noise is alike
on all axes and independent between them, so one 2x2 covariance serves every axis.
"""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Floats

MANEUVER_S = 0.1
"""How long an acceleration lasts; see `density_from_acceleration`."""
START_S = 0.5
"""A new track may be as fast as this time of full acceleration makes it (one standard deviation)."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Values and rates of one or several axes at one instant, with the covariance that the axes share."""

    value: Floats
    """Shape (axes,)."""
    rate: Floats
    """Per second, shape (axes,)."""
    variance: float
    """Of each value."""
    covariance: float
    """Between each value and its rate."""
    rate_variance: float

    @property
    def sd(self) -> float:
        """Standard deviation of each value."""
        return math.sqrt(self.variance)

    def predicted(self, duration_s: float, density: float) -> "Motion":
        """The state a duration [s] later (or earlier, when negative), surer of nothing.

        density: spectral density of the acceleration noise [unit^2/s^3].
        """
        t, span = duration_s, abs(duration_s)
        return Motion(
            self.value + self.rate * t,
            self.rate,
            self.variance + t * (2.0 * self.covariance + t * self.rate_variance) + density * span**3 / 3.0,
            self.covariance + t * self.rate_variance + density * t * span / 2.0,
            self.rate_variance + density * span,
        )

    def corrected(self, innovation: Floats, noise_variance: float) -> "Motion":
        """The state after a measurement of the values.

        innovation: measured minus predicted values, shape (axes,): angles are wrapped by the caller.
        """
        total = self.variance + noise_variance
        gain, rate_gain = self.variance / total, self.covariance / total
        return Motion(
            self.value + gain * innovation,
            self.rate + rate_gain * innovation,
            gain * noise_variance,
            rate_gain * noise_variance,
            self.rate_variance - rate_gain * self.covariance,
        )


def started(value: Floats, noise_variance: float, acceleration: float) -> Motion:
    """The state after a first measurement: at rest, and very unsure of it. acceleration: [unit/s^2]."""
    return Motion(value, np.zeros_like(value), noise_variance, 0.0, (acceleration * START_S) ** 2)


def density_from_acceleration(acceleration: float) -> float:
    """Spectral density of white noise that disturbs like accelerations of a standard deviation.

    Chosen so that a rate changes within `MANEUVER_S` by acceleration x MANEUVER_S (one standard
    deviation), at every frame rate. acceleration: [unit/s^2]; returns [unit^2/s^3].
    """
    return acceleration**2 * MANEUVER_S
