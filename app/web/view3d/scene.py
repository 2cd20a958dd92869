"""The whole scene: what stands still once, what moves with every call of ``show``; layers and the selected robot."""

from collections.abc import Mapping

import numpy as np
import viser
from viser import _messages

from app.web.view3d.robots import Robots3D
from app.web.view3d.sights import Ball3D, Contours3D, Robot, Sights3D
from app.web.view3d.stadium import add_camera, add_field, add_walls
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import mirrors_of
from vision_core.settings.schema import MatchSettings, Settings
from vision_core.types.objects import Team
from vision_core.types.regions import BodyContours
from vision_core.types.tracks import RobotTrack, World
from vision_core.types.views import Views

LAYERS: Mapping[str, tuple[str, ...]] = {
    "field": ("/field",),
    "cameras": ("/cameras",),
    "robots": ("/robots",),
    "ball": ("/ball",),
    "floor that robots hide": ("/contours",),
    "edges that robots see": ("/edges",),
    "rays of one robot": ("/rays",),
    "its mirror's horizon": ("/horizon",),
}
"""What each viewer can switch on and off, with the nodes of the scene."""
BACKGROUND_RGB = (92, 100, 110)
"""Readable beside the page's light and dark theme."""
NOBODY = "no robot"


class Scene:
    """The scene of one viser server."""

    def __init__(self, server: viser.ViserServer, settings: Settings) -> None:
        self._server = server
        self._settings = settings
        self._blue_defends = settings.match.blue_defends
        self.selected: Robot | None = None
        """The robot whose rays are drawn."""
        scene = server.scene
        scene.set_background_image(np.full((2, 2, 3), BACKGROUND_RGB, dtype=np.uint8), format="png")
        for layer in {node for nodes in LAYERS.values() for node in nodes} - {
            "/contours",
            "/edges",
            "/rays",
            "/horizon",
        }:
            scene.add_frame(layer, show_axes=False)
        add_field(scene, settings.field)
        add_walls(scene, settings, self._blue_defends)
        add_camera(scene, CameraSetup.from_settings(settings))
        self._robots = Robots3D(scene, settings)
        self._ball = Ball3D(scene, settings.ball.radius_m)
        self._contours = Contours3D(scene)
        self._sights = Sights3D(scene)
        self._place_viewer()
        self._add_panel()
        server.on_client_connect(self._add_layers)

    def show(self, world: World | None, views: Views | None, contours: BodyContours | None, settings: Settings) -> None:
        """Draw a world, the views that belong to it and what robots hide from the camera; None hides what moves.

        settings: those in effect.
        """
        match = settings.match
        if match.blue_defends != self._blue_defends:
            self._blue_defends = match.blue_defends
            add_walls(self._server.scene, self._settings, match.blue_defends)
        robots = world.robots if world else ()
        with self._server.atomic():
            self._robots.show(robots)
            self._ball.show(world.ball if world else None)
            self._contours.show(contours.bodies if contours else ())
            shown = views.views if views else ()
            self._sights.show(shown, _by_number(robots, match), mirrors_of(settings.mirror), self.selected)

    def _place_viewer(self) -> None:
        """Everybody begins beside the field, looking at its center."""
        field = self._settings.field
        self._server.initial_camera.position = (0.0, -1.1 * field.width_m, 0.9 * field.length_m)
        self._server.initial_camera.look_at = (0.0, 0.0, 0.0)
        self._server.initial_camera.up = (0.0, 0.0, 1.0)

    def _add_panel(self) -> None:
        gui, numbers = self._server.gui, self._settings.match.numbers
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="small")
        gui.main_panel.minimize()
        robots = {f"{team.value} {number}": (team, number) for team in Team for number in range(1, numbers + 1)}
        choice = gui.add_dropdown("rays of", (NOBODY, *robots), initial_value=NOBODY)

        @choice.on_update
        def _(_event: object) -> None:
            self.selected = robots.get(choice.value)

    def _add_layers(self, client: viser.ClientHandle) -> None:
        """Give a viewer switches of his own for the layers."""
        for layer, nodes in LAYERS.items():
            self._add_layer(client, layer, nodes)

    def _add_layer(self, client: viser.ClientHandle, layer: str, nodes: tuple[str, ...]) -> None:
        switch = client.gui.add_checkbox(layer, initial_value=True)

        @switch.on_update
        def _(_event: object) -> None:
            for node in nodes:
                message = _messages.SetSceneNodeVisibilityMessage(node, switch.value)
                client.scene._websock_interface.queue_message(message)


def _by_number(robots: tuple[RobotTrack, ...], match: MatchSettings) -> dict[Robot, RobotTrack]:
    """The robots that clients can have, by team and number."""
    numbers = {(team, marker): number for team in Team for number, marker in enumerate(match.ids_of(team), start=1)}
    return {
        (robot.team, numbers[robot.team, robot.id]): robot
        for robot in robots
        if robot.id is not None and (robot.team, robot.id) in numbers
    }
