"""The client module of the paper (section 3.4): takes the place of the on-board camera in a robot's program.

    from vision_core.client import connect

    with connect("127.0.0.1", 6000, "blue", 3) as robot:
        for view in robot:
            print(view.time_s, view.mm.min(), view.ball.direction_deg)

Theory of operation. ``connect`` sends ``(init blue 3)`` until the server answers. A ``Connection`` then
turns each ``see`` into a ``View`` of arrays; older datagrams than the last one are dropped, and
``latest`` skips to the newest. It keeps the session alive, and when the server was restarted it asks
again, so iteration goes on. Once a second it reports its share of the lag: from a view's arrival to the
program's next call. Silence is normal, the camera may not see the robot: it is ``None``, no error.
Millimetres are as right as the mirror that ``connect`` is told; pixels need none.

NumPy and the standard library are enough, on any system. Files: ``connection``, ``view``, ``lag``, and
``__main__``, the command ``python -m vision_core.client``.
"""

from vision_core.client.connection import Connection, connect
from vision_core.client.view import View
from vision_core.models.mirror import Mirror
from vision_core.protocol.options import Options

__all__ = ["Connection", "Mirror", "Options", "View", "connect"]
