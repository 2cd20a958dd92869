"""The on-board side: the picture of the same world through the mirror, and what the on-board module makes of it."""

import math

import numpy as np

from vision_core.capture.synthetic.floor import COLORS, WOOD
from vision_core.capture.synthetic.world import Snapshot
from vision_core.client.recognition.geometry import paper_geometry
from vision_core.client.recognition.palette import RENDERED, Palette, Surface
from vision_core.client.recognition.recognize import recognize
from vision_core.fidelity.reports import Report, report_of
from vision_core.fidelity.wall_lines import without_wall_lines
from vision_core.fidelity.worlds import VIEWER, Setup
from vision_core.geometry import Bytes, Floats
from vision_core.models.field import line_at_walls_m
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.scene import Scene
from vision_core.onboard.truth import FirstSolids, SeenBall, first_solids, seen_ball
from vision_core.protocol.messages import HIDDEN, Ball


class OnboardSide:
    """Renders what the viewer's own camera shows of worlds, and recognizes it. No truth is used but to score."""

    def __init__(self, setup: Setup, mirror: Mirror) -> None:
        self.settings = settings = setup.settings
        self.mirror = mirror
        self.camera = OnboardCamera(settings, VIEWER, size_px=setup.onboard_px, mirror=mirror)
        self.geometry = paper_geometry(
            mirror,
            setup.onboard_px,
            nearest_mm=self.camera.nearest_floor_m * MM_PER_M,
            ball_radius_mm=settings.ball.radius_m * MM_PER_M,
        )
        self.line_mm = line_at_walls_m(settings.field) * MM_PER_M
        """Width of the line at the walls' feet; 0: reports are left as they are."""
        self._palette = RENDERED if settings.field.walls else _palette_with_wood()

    def scene(self, snapshot: Snapshot) -> Scene:
        """What stands around the viewer.

        A virtual limit is the end of the carpet here: an on-board camera sees nothing of a line 10 mm wide from far.
        """
        scene = self.camera.scene(snapshot)
        venue = scene.ground.venue
        if venue.walls:
            return scene
        cut = venue._replace(carpet_x=venue.half_x, carpet_y=venue.half_y)
        return scene._replace(ground=scene.ground._replace(venue=cut))

    def picture(self, scene: Scene) -> Bytes:
        """The on-board picture: blue green red, shape (height, width, 3)."""
        return self.camera.picture(scene)

    def report(self, picture: Bytes) -> Report:
        """What the on-board module recognizes in a picture."""
        seen = recognize(picture, self.geometry, self._palette)
        report = Report(seen.letters, seen.radii_px, seen.ball)
        return without_wall_lines(report, self.line_mm, self.mirror) if self.line_mm else report

    def first_solids(self, scene: Scene, rays: int) -> FirstSolids:
        """What the picture shows, exactly, in evenly spaced directions."""
        return first_solids(scene, np.arange(rays, dtype=np.float64) * (360.0 / rays))

    def true_report(self, scene: Scene, solids: FirstSolids) -> Report:
        """What an on-board module without error would recognize."""
        return report_of(solids.kinds, solids.foot_mm, self.mirror, self.true_ball(seen_ball(scene)))

    def true_ball(self, ball: SeenBall) -> Ball:
        """The ball as the protocol says it; hidden when no part of it is seen."""
        if ball.share <= 0.0:
            return HIDDEN
        px = int(self.mirror.px_from_mm(ball.distance_mm))
        return Ball(px, math.floor(ball.direction_deg + 0.5) % 360, max(math.floor(ball.size_deg + 0.5), 1))


def _palette_with_wood() -> Palette:
    """The colors of a field without walls: where the carpet ends, the floor beside the field is its limit."""
    wood: Floats = COLORS[WOOD][::-1]
    red, green, blue = wood.tolist()
    tones = tuple((Surface.WALL, (int(k * red), int(k * green), int(k * blue))) for k in (1.0, 0.8, 0.6))
    return Palette((*RENDERED.colors, *tones), RENDERED.tolerance, RENDERED.dark_feet)
