"""Where robots may be that the blobs do not show: what a search of the whole picture for shapes says."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from vision_core.color.light import field_samples
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.camera_kernels import camera_map_from
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.objects.robots.confirmation import OVERLAP, SUGGESTED_SCORE
from vision_core.objects.robots.confirmation_buffers import MAX_SUGGESTED, SUGGESTED, Shapes
from vision_core.objects.robots.held import is_read
from vision_core.objects.robots.marker_shape import scene_of
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.shape_search import Candidate, find_candidates
from vision_core.settings.schema import Settings
from vision_core.types.tables import Table


class Suggestions(NamedTuple):
    """Poses at which the hot path looks for robots, and what the floor looks like there."""

    plain: Floats
    """See ``marker_shape.Scene``, shape (3,)."""
    poses: Table
    """SUGGESTED, at most MAX_SUGGESTED rows."""


NOTHING = Suggestions(frozen(np.zeros(3)), frozen(np.zeros(0, dtype=SUGGESTED)))


class ShapeSearch:
    """Searches pictures of one camera. It takes a fraction of a second per picture."""

    def __init__(self, settings: Settings, camera: CameraSetup, markers: tuple[Marker, ...], shapes: Shapes) -> None:
        self._camera, self._map = camera, camera_map_from(camera.model)
        self._markers, self._shapes = markers, shapes
        self._look_of = {
            (marker.team, number): look
            for marker, look in zip(markers, shapes.looks.tolist(), strict=True)
            for number in marker.ids.tolist()
        }
        self._half_extent_m = accepted_half_extent(settings.field)
        self._floor = field_samples(camera.model, settings.field, camera.size_px, -settings.field.margin_m)

    def suggest(self, pixels: Bytes, read: Table) -> Suggestions:
        """Where markers may be beside the robots that are read.

        pixels: in the venue's light, shape (height, width, 3); read: ROBOT, what was found in them.
        """
        scene = scene_of(pixels, self._floor)

        def search(look: int) -> Sequence[Candidate]:
            template, height_m = self._shapes.templates[look], self._markers[look].height_m
            return find_candidates(pixels, scene, self._map, template, height_m, self._half_extent_m)

        return Suggestions(scene.plain, self.beside(search, read))

    def beside(self, search: Callable[[int], Sequence[Candidate]], read: Table) -> Table:
        """The poses of candidates that are no robot which is read: SUGGESTED.

        search: what looks like a marker, by its number.
        """
        rows: list[tuple[float, ...]] = []
        known = [robot for robot in read if is_read(robot)]
        place = 0
        for look in sorted({int(look) for look in self._shapes.looks}):
            apart = OVERLAP * self._markers[look].radius_m
            for candidate in search(look):
                score, x, y = candidate.poses[0, :3]
                beside = all(math.hypot(robot["x_m"] - x, robot["y_m"] - y) >= apart for robot in known)
                if score >= SUGGESTED_SCORE and beside and not self._is_masked(look, x, y):
                    place += 1
                    rows += [(place, look, *map(float, pose[1:4])) for pose in candidate.poses]
        return np.array(rows[:MAX_SUGGESTED], dtype=SUGGESTED)

    def new_poses(self, before: Table, robots: Table) -> Table:
        """The poses of robots that were not read before: SUGGESTED. before, robots: ROBOT."""
        known = {(robot["team"], robot["id"]) for robot in before if is_read(robot)}
        new = [robot for robot in robots if is_read(robot) and (robot["team"], robot["id"]) not in known]
        rows = [
            (place, self._look_of[robot["team"], robot["id"]], robot["x_m"], robot["y_m"], robot["heading_rad"])
            for place, robot in enumerate(new)
        ]
        return np.array(rows, dtype=SUGGESTED)

    def _is_masked(self, look: int, x_m: float, y_m: float) -> bool:
        """Does a place lie where nothing is looked for?"""
        if self._camera.masked is None:
            return False
        u, v = self._camera.model.pixel_from_field(np.array([[x_m, y_m]]), self._markers[look].height_m)[0]
        return bool(self._camera.masked[int(v), int(u)])
