"""Memory that confirming robots works in, allocated once, and where a search suggests some."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats, frozen
from vision_core.objects.robots.buffers import MAX_SLOTS, PATCH_COLUMNS
from vision_core.objects.robots.marker_shape import ROOTS
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.template import Template, template_of
from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.tables import ROBOT, TEAMS, Table

SUGGESTED = np.dtype(
    [("place", np.int32), ("marker", np.int32), ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64)]
)
"""A pose where a marker may be. place: its number; poses of one place follow each other. marker: the first one that
looks the same without its colors."""
MAX_SUGGESTED = 64

ENERGY, SECOND, PLAIN, WORST, SCORE = range(5)
"""What is kept of the best way to read a place: its energy, that of the best other robot, that of plain things, the
energy of its worst patch, and how clear the shape is."""


class Reading(NamedTuple):
    """Scratch: the best way to read a place, and what rivals it."""

    values: Floats
    """See ``ENERGY``, shape (5,)."""
    robot: Table
    """The best one, ROBOT, shape (1,)."""
    tried: Table
    """ROBOT, shape (1,)."""
    pose: Floats
    """Of ``fit_shape``."""
    patches: Floats
    """Of ``measure_patches``."""


class Shapes(NamedTuple):
    """What the robots' markers look like, and where a search suggests some. Kernels take it as one argument."""

    templates: tuple[Template, ...]
    """Of every marker."""
    looks: NDArray[np.int32]
    """Of every marker the first one that looks the same without its colors."""
    roots: Floats
    plain: Floats
    """See ``Scene``; all 0 while it is not known."""
    suggested: Table
    """SUGGESTED, shape (MAX_SUGGESTED,)."""
    size: NDArray[np.int64]
    """How many are suggested, shape (1,)."""
    reading: Reading


def shapes_from(settings: Settings, markers: tuple[Marker, ...]) -> Shapes:
    """The memory for both teams' markers; nothing is suggested."""
    patterns = [pattern for team in TEAMS for pattern in worn_patterns(settings.robots, team)]
    templates = tuple(template_of(pattern) for pattern in patterns)
    looks = [
        next(
            other
            for other in range(len(markers))
            if templates[other].points_m.tobytes() == template.points_m.tobytes()
            and markers[other].height_m == marker.height_m
        )
        for marker, template in zip(markers, templates, strict=True)
    ]
    patches = np.zeros((1 + MAX_SLOTS, PATCH_COLUMNS))
    reading = Reading(np.zeros(5), np.zeros(1, dtype=ROBOT), np.zeros(1, dtype=ROBOT), np.zeros(5), patches)
    return Shapes(
        templates, frozen(np.array(looks, dtype=np.int32)), ROOTS, np.zeros(3),
        np.zeros(MAX_SUGGESTED, dtype=SUGGESTED), np.zeros(1, dtype=np.int64), reading,
    )  # fmt: skip
