"""People who walk beside the field: the camera sees their feet."""

import math

import numpy as np

from vision_core.capture.synthetic.bodies import no_bodies
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.field import accepted_half_extent
from vision_core.settings.schema import Settings

WALK_M_S = 0.5
STRIDE_S = 1.1
"""Mean speed of a person, and period of a foot's motion: it stops once per stride."""


def feet_paths(settings: Settings) -> Floats:
    """Straight paths beside the field on which people walk back and forth: x1, y1, x2, y2, phase [s]; shape (m, 5)."""
    rng = np.random.default_rng([settings.synthetic.seed, 2])
    half_x, half_y = accepted_half_extent(settings.field)
    goal = settings.field.goal.width_m / 2.0 + 0.25
    corner = max(half_y - 0.05, goal + 0.2)
    paths = []
    for i in range(settings.synthetic.walking_people):
        away = rng.uniform(0.10, 0.22)
        across = (-1.0 if i % 2 else 1.0) * (half_x + away)
        along = (-1.0 if i % 4 < 2 else 1.0) * (half_y + away)
        path = (across, goal, across, corner) if i % 3 < 2 else (-0.8 * half_x, along, 0.8 * half_x, along)
        paths.append((*path, rng.uniform(0.0, 20.0)))
    return np.array(paths).reshape(-1, 5)


def feet_at(paths: Floats, time_s: float) -> Floats:
    """Feet on their paths at a time. Each foot stops once per stride; people turn round at the ends."""
    feet = no_bodies(len(paths))
    for i, (x1, y1, x2, y2, phase_s) in enumerate(paths):
        length = math.hypot(x2 - x1, y2 - y1)
        step_rate = math.tau / STRIDE_S
        now = time_s + phase_s
        walked_m = WALK_M_S * (now - math.sin(step_rate * now) / step_rate)
        speed = WALK_M_S * (1.0 - math.cos(step_rate * now))
        on_way_out = walked_m % (2.0 * length) < length
        fraction = walked_m % length / length
        angle = math.atan2(y2 - y1, x2 - x1)
        if not on_way_out:
            fraction, angle = 1.0 - fraction, wrap_angle(angle + math.pi)
        feet[i] = (
            x1 + fraction * (x2 - x1), y1 + fraction * (y2 - y1), angle,
            speed * math.cos(angle), speed * math.sin(angle), 0.0,
        )  # fmt: skip
    return feet
