"""What a client measures of its views: rate, losses, gaps, lag, clock."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.client.connection import Connection
from vision_core.client.view import View
from vision_core.clock import MS_PER_S, Clock, after, seconds_between
from vision_core.examination.findings import Finding, bad, doubtful, good
from vision_core.geometry import Floats

PATIENCE_S = 1.0
GOOD_LOSS, BAD_LOSS = 0.005, 0.05
"""Share of the views that are missing: up to the first good, above the second bad."""
GOOD_LAG_PERIODS = 2.0
GOOD_BOUND_S = 1e-3
ENOUGH_RATE = 0.95
"""Share of the camera's rate."""


@dataclass(frozen=True, slots=True)
class Watched:
    """The views of some seconds."""

    seconds: float
    views: Sequence[View]

    @property
    def seen(self) -> Sequence[View]:
        """Those in which the camera saw the robot."""
        return [view for view in self.views if view.is_seen]

    @property
    def intervals_s(self) -> Floats:
        """Between the images of one view and the next [s], shape (views - 1,)."""
        return np.diff([view.time_s for view in self.views])

    def steps(self, period_s: float | None) -> Floats:
        """How many images the camera took from one view to the next, shape (views - 1,).

        By the images' numbers; a server of version 1 tells none, so there the time counts. period_s: between two
        images, None: not told.
        """
        numbers = [view.seq for view in self.views if view.seq is not None]
        if len(numbers) == len(self.views):
            return np.diff(np.array(numbers, dtype=np.float64))
        return np.rint(self.intervals_s / (period_s or float(np.median(self.intervals_s))))


def watch(robot: Connection, seconds: float, clock: Clock) -> Watched:
    """Read all views for some seconds. Raises ConnectionRefused when the server ends the session."""
    begin, views = clock.now(), []
    end = after(begin, seconds)
    while (left_s := seconds_between(clock.now(), end)) > 0.0:
        view = robot.receive(min(left_s, PATIENCE_S))
        if view is not None:
            views.append(view)
    return Watched(seconds_between(begin, clock.now()), views)


def on_sight(watched: Watched, robot: str) -> Finding:
    """Does the camera see the robot?"""
    seen, count = len(watched.seen), len(watched.views)
    if seen == 0:
        return bad("sight", f"the camera does not see {robot}: put the robot on the field, with its marker up")
    if seen < count:
        return doubtful("sight", f"the camera sees {robot} in {seen} of {count} images only")
    return good("sight", f"the camera sees {robot} in all {count} images")


def on_rate(watched: Watched, period_s: float | None) -> Finding:
    """Do so many views come as the camera takes images? period_s: between two images, None: not told."""
    rate_hz = len(watched.views) / watched.seconds
    said = f"{rate_hz:.1f} views a second"
    if period_s is None:
        return good("rate", said)
    wanted_hz = 1.0 / period_s
    if rate_hz >= ENOUGH_RATE * wanted_hz:
        return good("rate", f"{said}; the camera takes {wanted_hz:.1f} images a second")
    why = "a match fixes a lower rate, or the server or the network does not keep up"
    return doubtful("rate", f"{said}, but the camera takes {wanted_hz:.1f} images a second: {why}")


def on_losses(watched: Watched, period_s: float | None) -> Finding:
    """How many images gave no view, and how long was the longest gap? period_s: as in ``on_rate``.

    Where views come of every second image or less often, a match has fixed their rate, and that one counts.
    """
    steps = watched.steps(period_s)
    usual = max(float(np.median(steps)), 1.0)
    missing = int(np.maximum(np.rint(steps / usual) - 1.0, 0.0).sum())
    images = missing + len(watched.views)
    gap_ms = float(watched.intervals_s.max()) * MS_PER_S
    said = f"{missing} of {images} views are missing; the longest gap is {gap_ms:.0f} ms"
    if missing <= GOOD_LOSS * images:
        return good("losses", said)
    cure = "the network loses them (a cable or a free channel loses fewer), or the server is too slow"
    return (doubtful if missing <= BAD_LOSS * images else bad)("losses", f"{said}: {cure}")


def on_lag(watched: Watched) -> Finding:
    """How old are views when they arrive?"""
    known = [view for view in watched.views if math.isfinite(view.age_s)]
    if not known:
        return doubtful("lag", "the server does not tell its clock, so the age of views is not known")
    p50_ms, p99_ms = np.percentile([view.age_s for view in known], (50, 99)) * MS_PER_S
    bound_ms = max(view.age_bound_s for view in known) * MS_PER_S
    said = f"views are {p50_ms:.1f} ms old when they arrive, 99 of 100 at most {p99_ms:.1f} ms, +- {bound_ms:.1f} ms"
    if lags := [view.lag for view in known if view.lag is not None]:
        said += f"; {np.median([lag.server_s for lag in lags]) * MS_PER_S:.1f} ms until they are sent"
    limit_ms = GOOD_LAG_PERIODS * float(np.median(watched.intervals_s)) * MS_PER_S
    if p99_ms <= limit_ms:
        return good("lag", said)
    return doubtful(
        "lag", f"{said}: that is more than {limit_ms:.0f} ms, two images; look at the network and the server"
    )


def on_clock(robot: Connection) -> Finding:
    """How well is the server's clock known?"""
    _, bound_s = robot.server_time()
    if not math.isfinite(bound_s):
        return doubtful("clock", "the server's clock is not known: it speaks version 1, or answers no (sync ...)")
    said = f"the server's clock is known to {bound_s * MS_PER_S:.2f} ms"
    if bound_s <= GOOD_BOUND_S:
        return good("clock", said)
    return doubtful("clock", f"{said}: the way there and back takes long, or how long it takes varies")
