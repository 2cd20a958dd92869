"""The client module of the paper (section 3.4): replaces the on-board camera in a robot's program.

    from vision_core.client import connect

    with connect("127.0.0.1", 6000, "blue", 3) as robot:
        for view in robot:
            print(view.time_s, view.mm.min(), view.ball.direction_deg)

Theory of operation. ``connect`` sends ``(init blue 3)`` until the server answers, and asks for the mirror of its field.
A ``Connection`` then turns each ``see`` into a ``View`` of arrays; it skips views that are older than the last one, and
``latest`` returns the newest. So does iteration each time, and ``on_view`` gives it to a function: a slow program
misses views, and sees none late. It keeps the session alive; when the server was restarted it asks again, says so
(``Connection.restarts`` and the logger "vision_core.client"), and iteration goes on. It asks for the server's clock, so
each view says how old it is, and how sure that is; with the extra ``age`` also how its lag is made up. Once a second it
reports its share of the lag: from a view's arrival to the program's next call. Silence is normal when the camera does
not see the robot: ``receive`` then returns None and raises nothing. Distances in millimetres depend on the mirror:
``connect`` raises if it is neither given nor told by the server. In a simulated venue ``Connection.drive`` drives the
robot.

A program that was written for a camera takes ``camera.Camera`` in its place: the views as pictures (``panorama``).
``recognition`` is the other way round, from an on-board picture to a view; ``comparison`` puts both beside each other.

It needs NumPy and the standard library only, on any system. Files: ``connecting``, ``connection``, ``following``,
``driving``, ``addresses``, ``refusals``, ``view``, ``extras``, ``lag``, ``clock_sync``, ``clock_fit``, ``camera``,
``panorama``, ``png``, ``comparison``, ``own_camera``, and ``__main__``, the command ``python -m vision_core.client``.
"""

from vision_core.client.connecting import connect
from vision_core.client.connection import Connection
from vision_core.client.driving import Robot
from vision_core.client.extras import Extras
from vision_core.client.following import ViewThread
from vision_core.client.lag import Lag
from vision_core.client.view import View
from vision_core.models.mirror import Mirror
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.options import Options

__all__ = [
    "Connection",
    "Drive",
    "DriveLimits",
    "Extras",
    "Lag",
    "Mirror",
    "Options",
    "Robot",
    "View",
    "ViewThread",
    "connect",
]
