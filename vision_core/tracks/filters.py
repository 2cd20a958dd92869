"""A constant-velocity Kalman filter (white-noise acceleration), for one axis or for several with the same noise.

State per axis: value and rate. Acceleration is white noise of spectral density q, so that over a time t

    F = [1 t; 0 1],   Q = q [t^3/3  t^2/2; t^2/2  t]        (Bar-Shalom et al. 2001, section 6.2.2)

Q composes: two steps of t/2 give what one step of t gives, so the frame rate does not matter. The noise of all
axes is equal and independent, so one 2x2 covariance matrix serves every axis: variance of the value,
covariance of value and rate, variance of the rate. The values themselves need one line each
(value + rate * t; value + gain * innovation), which stands in the module of each kind of track.
"""

from vision_core.native.kernels import kernel

MANEUVER_S = 0.1
"""Duration of one acceleration; see `density_from_acceleration`."""
START_S = 0.5
"""Standard deviation of a new track's velocity: full acceleration during this time."""


def density_from_acceleration(acceleration: float) -> float:
    """Spectral density of the white noise that models accelerations of a standard deviation.

    Chosen so that a rate changes within `MANEUVER_S` by acceleration x MANEUVER_S (one standard
    deviation), at every frame rate. acceleration: [unit/s^2]; returns [unit^2/s^3].
    """
    return acceleration**2 * MANEUVER_S


def start_variance(acceleration: float) -> float:
    """Variance of the rate of a track after its first sighting: the rate is 0, give or take `START_S` of acceleration.

    acceleration: [unit/s^2]; returns [unit^2/s^2].
    """
    return (acceleration * START_S) ** 2


@kernel
def predicted(
    variance: float, covariance: float, rate_variance: float, t: float, density: float
) -> tuple[float, float, float]:
    """The covariance matrix (variance, covariance, rate variance) a duration t [s] later; earlier when t < 0.

    Process noise is added in both directions of time. density: of the acceleration noise [unit^2/s^3].
    """
    span = abs(t)
    return (
        variance + t * (2.0 * covariance + t * rate_variance) + density * span**3 / 3.0,
        covariance + t * rate_variance + density * t * span / 2.0,
        rate_variance + density * span,
    )


@kernel
def corrected(
    variance: float, covariance: float, rate_variance: float, noise: float
) -> tuple[float, float, float, float, float]:
    """Gain of the value, gain of the rate, and the covariance matrix after a measurement of the value.

    noise: variance of the measurement [unit^2]. The gains multiply the innovation, measured minus predicted value.
    """
    total = variance + noise
    gain, rate_gain = variance / total, covariance / total
    return gain, rate_gain, gain * noise, rate_gain * noise, rate_variance - rate_gain * covariance
